// What a person should know of the meshes of a scene: what was mended, and what looks like another unit or
// another place than meant.
#include "server/scene/mesh_notes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "server/base/text.h"
#include "server/scene/placement.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

namespace {

// What people simulate cloth with is larger and smaller than this: a handkerchief, a marquee [m].
constexpr double smallest_size = 0.05, largest_size = 10.0;
constexpr double usual_smallest = 0.2, usual_largest = 5.0;  // what a change of unit should lead to [m]
constexpr double far_away = 100.0;                           // [m]; beyond, floats are 8 um and more apart
constexpr double far_in_sizes = 10.0;
constexpr double float_spacing = 0x1p-23;     // over the number, at most
constexpr double most_pattern_stretch = 2.0;  // no cloth is cut half or twice as long as it is worn

/// With three significant digits, and without an exponent.
std::string digits(double number) {
  return with_significant_digits(std::stod(formatted("%.2e", number)), 9);
}

/// The mesh's largest extent along an axis and the middle of its box, in world space [m].
struct Extent {
  double size = 0;
  dvec3 middle{0.0};
};
Extent extent_of(const TriangleMesh& mesh, const Transform& transform) {
  if (mesh.vertices.empty()) return {};
  dvec3 low = mesh.vertices[0], high = low;
  for (const dvec3& vertex : mesh.vertices) {
    low = glm::min(low, vertex);
    high = glm::max(high, vertex);
  }
  const dvec3 sides = transform.scale * (high - low);
  return {std::max({sides.x, sides.y, sides.z}), placed(transform, {0.5 * (low + high)})[0]};
}

std::string size_note(const Extent& extent, const Transform& transform) {
  if (!(extent.size > 0.0) || (extent.size >= smallest_size && extent.size <= largest_size)) return "";
  std::string note = "it is " + digits(extent.size) + " m large: is it in another unit? ";
  if (const std::optional<double> factor = unit_factor(extent.size))
    return note + "\"transform\": {\"scale\": " + digits(transform.scale * *factor) + "} makes it " +
           digits(extent.size * *factor) + " m";
  return note + "\"transform\": {\"scale\": ...} changes that";
}

std::string place_note(const Extent& extent, const Transform& transform) {
  const double distance = glm::length(extent.middle);
  if (!(distance > far_away && distance > far_in_sizes * extent.size)) return "";
  const auto back = [&](int axis) { return digits(transform.translate[axis] - extent.middle[axis]); };
  return "it lies " + digits(distance) + " m from the origin, where numbers are up to " +
         digits(1000.0 * distance * float_spacing) +
         " mm apart, which makes cloth tremble: move the scene to the origin, this mesh by \"transform\": "
         "{\"translate\": [" +
         back(0) + ", " + back(1) + ", " + back(2) + "]}";
}

double area(const dvec3& a, const dvec3& b, const dvec3& c) {
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// Of a mesh with a pattern.
std::string pattern_note(const TriangleMesh& mesh) {
  double surface = 0.0, pattern = 0.0;
  for (std::size_t i = 0; i < mesh.pattern.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    surface += area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    const auto& [u, v, w] = mesh.pattern[i];
    pattern += area({u, 0.0}, {v, 0.0}, {w, 0.0});
  }
  if (!(surface > 0.0 && pattern > 0.0)) return "";
  const double ratio = std::sqrt(pattern / surface);
  if (ratio <= most_pattern_stretch && ratio >= 1.0 / most_pattern_stretch) return "";
  double factor = 1.0 / ratio;
  for (const double unit : {1000.0, 100.0, 10.0, 0.1, 0.01, 0.001})  // metres, centimetres, millimetres
    if (factor / unit < 1.3 && factor / unit > 1.0 / 1.3) factor = unit;
  return "its pattern is " + digits(ratio) +
         " times as long as its surface: is it in another unit? \"pattern_scale\": " + digits(factor) +
         " beside \"pattern\" makes them alike; without \"pattern\" the surface itself is at rest";
}

void add_notes(const std::string& place, const TriangleMesh& mesh, const Transform& transform,
               std::vector<std::string>& notes) {
  const Extent extent = extent_of(mesh, transform);
  const std::string size = size_note(extent, transform);
  for (const std::string& note : mesh.notes) notes.push_back(place + "/mesh: " + note);
  for (const std::string& note : {size, size.empty() ? place_note(extent, transform) : ""})
    if (!note.empty()) notes.push_back(place + "/transform: " + note);
  if (const std::string note = pattern_note(mesh); !note.empty())
    notes.push_back(place + "/mesh/pattern: " + note);
}

}  // namespace

std::optional<double> unit_factor(double size) {
  if (size >= smallest_size && size <= largest_size) return 1.0;
  for (const double factor : {0.01, 0.001, 100.0, 1000.0, 0.0254, 0.1, 10.0})
    if (size * factor >= usual_smallest && size * factor <= usual_largest) return factor;
  return std::nullopt;
}

std::vector<std::string> mesh_notes(const Scene& scene) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < scene.cloths.size(); ++i)
    if (const auto* mesh = std::get_if<TriangleMesh>(&scene.cloths[i].mesh))
      add_notes("/cloths/" + std::to_string(i), *mesh, scene.cloths[i].transform, notes);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    if (const auto* body = std::get_if<Body>(&scene.colliders[i].shape))
      add_notes("/colliders/" + std::to_string(i), *body->mesh, body->transform, notes);
  return notes;
}

}  // namespace clothlab::scene
