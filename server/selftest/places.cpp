#include "server/selftest/places.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/base/text.h"
#include "server/scene/document.h"

namespace clothlab::selftest {

namespace {

using nlohmann::json;

Error unreadable_places(const std::string& file, const std::string& what) {
  return {"server/selftest/places/" + file, what, "install Clothlab again"};
}

Result<json> read_json(const std::string& file) {
  const Result<std::filesystem::path> path = data_path("server/selftest/places/" + file);
  if (!path) return path.error();
  const Result<std::string> text = read_file(*path);
  if (!text) return text.error();
  return scene::parse_json(*text, file);
}

/// Lines of so many numbers each, as the items of a list.
std::string lines_of(const std::vector<double>& numbers, std::size_t in_line, const char* form) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    text += i % in_line == 0 ? (i == 0 ? "\n  [" : ",\n  [") : ", ";
    text += formatted(form, numbers[i]);
    if (i % in_line == in_line - 1) text += "]";
  }
  return text;
}

}  // namespace

Result<Places> read_places(const std::string& file) {
  const Result<json> value = read_json(file);
  if (!value) return value.error();
  try {
    Places places{value->at("allowed"), {}};
    for (const json& place : value->at("places"))
      places.position.emplace_back(place.at(0), place.at(1), place.at(2));
    return places;
  } catch (const json::exception& error) {
    return unreadable_places(file, error.what());
  }
}

Status write_places_file(const std::filesystem::path& file, const Places& places) {
  std::vector<double> numbers;
  for (const glm::dvec3& place : places.position) numbers.insert(numbers.end(), {place.x, place.y, place.z});
  return replace_file(file, formatted("{\"allowed\": %.2e, \"places\": [", places.allowed) +
                                lines_of(numbers, 3, "%.7f") + "]}\n");
}

Result<std::vector<double>> read_colours(const std::string& file) {
  const Result<json> value = read_json(file);
  if (!value) return value.error();
  try {
    std::vector<double> colours;
    for (const json& cell : value->at("colours"))
      for (const json& part : cell) colours.push_back(part);
    return colours;
  } catch (const json::exception& error) {
    return unreadable_places(file, error.what());
  }
}

Status write_colours(const std::filesystem::path& file, const std::vector<double>& colours) {
  return replace_file(file, "{\"colours\": [" + lines_of(colours, 3, "%.1f") + "]}\n");
}

}  // namespace clothlab::selftest
