// JSON Pointers (RFC 6901): text to tokens and back, and the rules for an index into an array; and the size
// of JSON values.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace clothlab::scene {

using nlohmann::json;

/// The token with each "~" escaped as "~0" and each "/" as "~1".
std::string escape_token(const std::string& token);

/// The unescaped tokens of `pointer`. Nothing if it is no JSON Pointer: "" or "/...", with "~" only in "~0"
/// and "~1".
std::optional<std::vector<std::string>> split_pointer(const std::string& pointer);

/// The array index in `token`, digits without a leading zero. Nothing if it is no index below `end`.
std::optional<std::size_t> array_index(const std::string& token, std::size_t end);

/// The member or element of `value` that `token` names, or null.
json* child(json& value, const std::string& token);

/// JSON on one line for a message; beyond 80 bytes it is cut and ends in "...".
std::string compact(const json& value);

/// The bytes of compact JSON; its text is made only in pieces.
std::size_t json_bytes(const json& value);

/// Levels of nesting: 0 for a number or a text, 1 for an array of them.
int depth(const json& value);

}  // namespace clothlab::scene
