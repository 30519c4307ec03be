// A recording is the committed bytes of tests/golden, which were written from server/stream/README.md. Other
// versions of zlib may compress otherwise: what each chunk holds is compared.
#include <zlib.h>

#include <cstring>

#include "server/base/files.h"
#include "server/stream/recording.h"
#include "tests/scenes.h"

using namespace clothlab;
using nlohmann::json;

namespace {

std::string golden(const std::string& name) {
  const Result<std::string> bytes = read_file(std::string(CLOTHLAB_SOURCE_DIR "/tests/golden/") + name);
  if (!bytes) FAIL(bytes.error().text());
  return *bytes;
}

std::string inflated(std::string_view bytes) {
  z_stream stream{};
  REQUIRE(inflateInit2(&stream, -15) == Z_OK);
  std::string out(100'000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int state = inflate(&stream, Z_FINISH);
  const std::size_t made = stream.total_out;
  inflateEnd(&stream);
  REQUIRE(state == Z_STREAM_END);
  REQUIRE(stream.avail_in == 0);
  return out.substr(0, made);
}

struct Chunk {
  std::string kind, head, content;
};

std::vector<Chunk> chunks_of(const std::string& file) {
  REQUIRE(file.substr(0, 16) == std::string("CLOTHLAB\1\0\0\0\0\0\0\0", 16));
  std::vector<Chunk> chunks;
  for (std::size_t at = 16; at < file.size();) {
    const std::string kind = file.substr(at, 4);
    std::uint32_t size = 0, check = 0;
    std::memcpy(&size, file.data() + at + 4, 4);
    std::memcpy(&check, file.data() + at + 8, 4);
    const std::string bytes = file.substr(at + 12, size);
    REQUIRE(bytes.size() == size);
    const std::string checked = kind + bytes;
    CHECK(check ==
          crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
    const std::size_t head = kind == "fram" ? 20 : 0;
    chunks.push_back({kind, bytes.substr(0, head), inflated(std::string_view(bytes).substr(head))});
    at += 12 + size;
  }
  return chunks;
}

bool is_json(const std::string& kind) {
  return kind == "head" || kind == "edit" || kind == "done";
}

/// The frames of a group, given to a recording as places.
void add_frames(stream::Recording& recording, const json& group) {
  const float quantum = group["quantum"];
  for (const json& frame : group["frames"]) {
    std::vector<glm::vec3> positions;
    for (const json& numbers : frame["numbers"])
      positions.emplace_back(quantum * numbers[0].get<float>(), quantum * numbers[1].get<float>(),
                             quantum * numbers[2].get<float>());
    // Bit 7 is for the writer to choose.
    const auto flags = static_cast<std::uint16_t>(frame["flags"].get<int>() & 127);
    recording.add({frame["time"], frame["step"], flags, positions,
                   frame["moving"].empty() ? json(nullptr) : frame["moving"]});
  }
}

}  // namespace

TEST_CASE("a recording holds the committed bytes") {
  const json expected = json::parse(golden("recording.json"));
  const scene::Document document = test::document_of(golden("recording.scene.json"));
  const Result<model::Model> model = model::build(document.scene);
  REQUIRE(model);
  std::string bytes;
  stream::Recording recording([&](std::string_view more) { bytes += more; }, expected["head"]["scene"],
                              expected["head"]["rate"]);
  recording.set_mesh(*model, document.scene);
  for (const json& group : expected["groups"]) {
    if (group.contains("edit_before")) recording.change(group["edit_before"]);
    add_frames(recording, group);
  }
  json ending = expected["done"];
  ending.erase("frames");
  recording.finish(ending);
  CHECK(recording.bytes() == bytes.size());
  CHECK(recording.frames() == 4);

  const std::vector<Chunk> made = chunks_of(bytes), committed = chunks_of(golden("recording.clothlab"));
  REQUIRE(made.size() == committed.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    INFO("chunk " << i << ", " << committed[i].kind);
    CHECK(made[i].kind == committed[i].kind);
    CHECK(made[i].head == committed[i].head);
    if (!is_json(made[i].kind)) {
      CHECK(made[i].content == committed[i].content);
      continue;
    }
    json ours = json::parse(made[i].content), theirs = json::parse(committed[i].content);
    if (made[i].kind == "head") ours.erase("program"), theirs.erase("program");
    CHECK(ours == theirs);
  }
}

TEST_CASE("many vertices make shorter groups, and a cloth that stands still costs next to nothing") {
  scene::Scene scene = test::sheet(300, 300);
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  std::vector<std::uint32_t> group_sizes;
  std::string bytes;
  stream::Recording recording([&](std::string_view more) { bytes += more; }, json::object(), 60);
  recording.set_mesh(*model, scene);
  const std::vector<glm::vec3> positions(model->rest_position.begin(), model->rest_position.end());
  for (int frame = 0; frame < 50; ++frame) recording.add({0.1 * frame, 1, 0, positions, {}});
  recording.finish(json::object());
  // 2^21 vertices at most: 23 frames of 90000. Of a cloth that stands still all but the first cost next to
  // nothing.
  std::vector<std::size_t> group_bytes;
  for (std::size_t at = 16; at < bytes.size();) {
    std::uint32_t size = 0, frames = 0;
    std::memcpy(&size, bytes.data() + at + 4, 4);
    std::memcpy(&frames, bytes.data() + at + 12, 4);
    if (bytes.substr(at, 4) == "fram") group_sizes.push_back(frames), group_bytes.push_back(size);
    at += 12 + size;
  }
  REQUIRE(group_sizes == std::vector<std::uint32_t>{23, 23, 4});
  CHECK(group_bytes[0] - group_bytes[2] < 19 * 90'000 / 100);
}
