#include "server/scene/pointer.h"

#include <algorithm>

namespace clothlab::scene {

std::string escape_token(const std::string& token) {
  std::string escaped;
  for (const char c : token) {
    if (c == '~')
      escaped += "~0";
    else if (c == '/')
      escaped += "~1";
    else
      escaped += c;
  }
  return escaped;
}

namespace {

std::optional<std::string> unescape_token(const std::string& token) {
  std::string plain;
  for (std::size_t i = 0; i < token.size(); ++i) {
    if (token[i] != '~') {
      plain += token[i];
      continue;
    }
    if (++i == token.size() || (token[i] != '0' && token[i] != '1')) return std::nullopt;
    plain += token[i] == '0' ? '~' : '/';
  }
  return plain;
}

}  // namespace

std::optional<std::vector<std::string>> split_pointer(const std::string& pointer) {
  std::vector<std::string> tokens;
  if (pointer.empty()) return tokens;
  if (pointer[0] != '/') return std::nullopt;
  for (std::size_t begin = 1; begin <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', begin), pointer.size());
    std::optional<std::string> token = unescape_token(pointer.substr(begin, end - begin));
    if (!token) return std::nullopt;
    tokens.push_back(std::move(*token));
    begin = end + 1;
  }
  return tokens;
}

std::optional<std::size_t> array_index(const std::string& token, std::size_t end) {
  if (token.empty() || token.size() > 9 || (token.size() > 1 && token[0] == '0')) return std::nullopt;
  std::size_t index = 0;
  for (const char c : token) {
    if (c < '0' || c > '9') return std::nullopt;
    index = index * 10 + static_cast<std::size_t>(c - '0');
  }
  return index < end ? std::optional(index) : std::nullopt;
}

json* child(json& value, const std::string& token) {
  if (value.is_object()) {
    const auto found = value.find(token);
    return found == value.end() ? nullptr : &*found;
  }
  if (!value.is_array()) return nullptr;
  const std::optional<std::size_t> index = array_index(token, value.size());
  return index ? &value[*index] : nullptr;
}

std::string compact(const json& value) {
  constexpr std::size_t longest = 80;
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // not within a character
  return text.substr(0, end) + "...";
}

std::size_t json_bytes(const json& value) {
  const auto text = [](const json& plain) {
    return plain.dump(-1, ' ', false, json::error_handler_t::replace).size();
  };
  if (!value.is_structured()) return text(value);
  std::size_t bytes = 2 + (value.empty() ? 0 : value.size() - 1);  // brackets and commas
  if (value.is_array())
    for (const json& element : value) bytes += json_bytes(element);
  else
    for (const auto& [key, element] : value.items()) bytes += text(key) + 1 + json_bytes(element);
  return bytes;
}

int depth(const json& value) {
  if (!value.is_structured()) return 0;
  int deepest = 0;
  for (const json& element : value) deepest = std::max(deepest, depth(element));
  return deepest + 1;
}

}  // namespace clothlab::scene
