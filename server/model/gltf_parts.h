// Parts of glTF 2.0 files that a file of one moment and a film have alike (Khronos Group, glTF 2.0
// specification; the sections are of it).
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace clothlab::model::gltf {

// Sections 3.6.2 and 3.6.2.3.
inline constexpr int float_component = 5126, index_component = 5125;
inline constexpr int vertex_target = 34962, index_target = 34963;

/// Everything of a binary file (section 4.4) up to the bytes of its buffer, of which there are
/// `binary_bytes`, a multiple of four.
std::string binary_file_head(const nlohmann::json& document, std::uint64_t binary_bytes);

/// A material that shows this colour, in linear light, on both sides.
nlohmann::json material(const std::string& name, const std::array<double, 3>& linear_colour);

}  // namespace clothlab::model::gltf
