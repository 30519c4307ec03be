// What a change of a scene is called, in the words of the scene's keys: "Gravity", "ball: radius", "Pin a
// vertex".
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothlab::session {

using nlohmann::json;

/// The places where two documents of scenes differ, each named once, in the order of the documents' keys.
std::vector<std::string> changed_places(const json& before, const json& after);

/// One name for all of them, of at most max_change_name_bytes: "Method, Time step", "Gravity and 3 more".
std::string change_name(const std::vector<std::string>& places);

inline constexpr std::size_t max_change_name_bytes = 80;

/// At most `most` bytes of a text, cut between two characters of UTF-8.
std::string shortened(std::string text, std::size_t most);

}  // namespace clothlab::session
