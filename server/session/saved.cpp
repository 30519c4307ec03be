#include "server/session/saved.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>

#include "server/base/text.h"
#include "server/scene/document.h"
#include "server/scene/ranges.h"

namespace clothlab::session {

namespace {

const std::string kind = "clothlab session ";
const std::string title = kind + "1\n";

std::string hash_text(const sim::State& state) {
  return formatted("%016llx", static_cast<unsigned long long>(sim::state_hash(state)));
}

Error unreadable(const std::string& what) {
  return {"saved session", what, "use a session file that this version of the program wrote"};
}

/// The error for a file of another version or another kind. It quotes the beginning of the file's first line.
Error other_file(const std::string& bytes) {
  if (bytes.empty()) return unreadable("it is empty");
  constexpr std::size_t longest = 40;
  std::string line = bytes.substr(0, std::min(bytes.find('\n'), longest));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c > '~' || c == '"'; }, '?');
  const std::string expected = title.substr(0, title.size() - 1);
  if (line.starts_with(kind))
    return unreadable("another version of the program wrote it: it begins with \"" + line +
                      "\", and this one reads \"" + expected + "\"");
  return unreadable("it is no saved session: it begins with \"" + line + "\", not with \"" + expected + "\"");
}

void append(std::string& bytes, const std::vector<glm::vec3>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(glm::vec3));
}

}  // namespace

std::string to_bytes(const Saved& saved) {
  const json head{{"document", saved.document},
                  {"revision", saved.revision},
                  {"playing", saved.playing},
                  {"speed", saved.speed},
                  {"time", saved.time},
                  {"step", saved.step},
                  {"vertices", saved.state.position.size()},
                  {"state_hash", hash_text(saved.state)}};
  std::string bytes = title + head.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  append(bytes, saved.state.position);
  append(bytes, saved.state.velocity);
  return bytes;
}

Result<Saved> saved_from(const std::string& bytes) {
  if (!bytes.starts_with(title)) return other_file(bytes);
  const std::size_t end = bytes.find('\n', title.size());
  if (end == std::string::npos) return unreadable("it ends too early");
  const Result<json> head = scene::parse_json(bytes.substr(title.size(), end - title.size()), "saved session",
                                              false, {scene::max_file_bytes, scene::max_json_depth + 1});
  if (!head) return head.error();
  try {
    Saved saved;
    saved.document = head->at("document");
    saved.revision = head->at("revision").get<std::uint64_t>();
    saved.playing = head->at("playing").get<bool>();
    saved.speed = head->at("speed").get<double>();
    saved.time = head->at("time").get<double>();
    saved.step = head->at("step").get<std::uint64_t>();
    const auto count = head->at("vertices").get<std::size_t>();
    const std::size_t size = count * sizeof(glm::vec3);
    if (count > scene::max_vertices || bytes.size() != end + 1 + 2 * size)
      return unreadable("its length is not that of " + std::to_string(count) + " vertices");
    saved.state.position.resize(count);
    saved.state.velocity.resize(count);
    std::memcpy(saved.state.position.data(), bytes.data() + end + 1, size);
    std::memcpy(saved.state.velocity.data(), bytes.data() + end + 1 + size, size);
    if (head->at("state_hash") != hash_text(saved.state)) return unreadable("its positions are damaged");
    return saved;
  } catch (const std::exception& problem) {  // from nlohmann: a key is missing or of another type
    return unreadable(problem.what());
  }
}

}  // namespace clothlab::session
