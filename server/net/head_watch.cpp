#include "server/net/head_watch.h"

#include <libwebsockets.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

namespace clothlab::net {

namespace {

constexpr std::size_t longest_name =
    64;  ///< bytes that are kept; all names that libwebsockets knows are shorter
constexpr unsigned char of_no_known_name = '!';  ///< a letter that headers may have, and no known one has

/// All that libwebsockets knows at the beginning of a line: headers with their colon, and methods.
const std::vector<std::string_view>& known_words() {
  static const std::vector<std::string_view> words = [] {
    std::vector<std::string_view> all;
    for (int token = 0; token < WSI_TOKEN_COUNT; ++token)
      if (const unsigned char* word = lws_token_to_string(static_cast<lws_token_indexes>(token)))
        all.emplace_back(reinterpret_cast<const char*>(word));
    return all;
  }();
  return words;
}

/// True if `name`, before its colon, is the beginning of known words alone, and none itself.
bool begins_known(std::string_view name) {
  bool begins = false;
  for (const std::string_view word : known_words()) {
    if (word.size() <= name.size() || !word.starts_with(name)) continue;
    if (word[name.size()] == ':') return false;
    begins = true;
  }
  return begins;
}

/// True if `beginning` of a name is a word that is none of a header: libwebsockets would take it for the
/// method of another request.
bool is_no_header(std::string_view beginning) {
  return std::any_of(known_words().begin(), known_words().end(), [beginning](std::string_view word) {
    return word == beginning && !word.ends_with(':') && !word.ends_with('\n');
  });
}

}  // namespace

std::size_t HeadWatch::filter(unsigned char* data, std::size_t size, std::size_t room) {
  for (std::size_t at = 0; at < size; ++at) {
    if (!take(data, at) || size == room) continue;
    std::memmove(data + at + 1, data + at, size - at);
    data[at++] = of_no_known_name;
    ++size;
  }
  return size;
}

bool HeadWatch::take(unsigned char* data, std::size_t at) {
  hurried_ = hurried_ || upgraded_;
  if (data[at] == '\n') {
    end_of_line(data, at);
    return false;
  }
  ++line_bytes_;
  if (part_ != Part::name) return false;
  if (data[at] == ':') return end_of_name(data, at);
  if (name_.size() == longest_name) return false;
  name_ += static_cast<char>(data[at] >= 'A' && data[at] <= 'Z' ? data[at] - 'A' + 'a' : data[at]);
  if (is_no_header(name_)) data[at] = of_no_known_name;
  return false;
}

bool HeadWatch::end_of_name(unsigned char* data, std::size_t at) {
  part_ = Part::value;
  upgrade_ = upgrade_ || name_ == "upgrade";
  if (!begins_known(name_)) return false;
  if (at == 0 || name_.empty()) return true;  // the name's last letter has been passed on already
  data[at - 1] = of_no_known_name;
  return false;
}

void HeadWatch::end_of_line(unsigned char* data, std::size_t at) {
  const bool blank = line_bytes_ == 0 || (line_bytes_ == 1 && (part_ == Part::request || name_ == "\r"));
  if (part_ == Part::name && !blank) {
    malformed_ = true;
    if (at > 0) data[at - 1] = ':';
    if (at > 1 && line_bytes_ > 1) data[at - 2] = of_no_known_name;
  }
  if (blank) {
    upgraded_ = upgraded_ || upgrade_;
    upgrade_ = false;
  }
  part_ = blank ? Part::request : Part::name;
  name_.clear();
  line_bytes_ = 0;
}

}  // namespace clothlab::net
