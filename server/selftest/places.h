// Places of vertices at the end of short runs that the reference cannot make, and the picture, as a device
// that is known to be right has made them: server/selftest/places/, written by
// `clothlab selftest --write-places`.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::selftest {

struct Places {
  double allowed = 0;                ///< RMS distance that another device may be away [m]
  std::vector<glm::dvec3> position;  ///< [vertex_count] [m]
};

Result<Places> read_places(const std::string& file);
Status write_places_file(const std::filesystem::path& file, const Places& places);

/// Mean colours of the cells of a picture, row by row: red, green, blue, each from 0 to 255.
Result<std::vector<double>> read_colours(const std::string& file);
Status write_colours(const std::filesystem::path& file, const std::vector<double>& colours);

}  // namespace clothlab::selftest
