// Scenes that are hard on contact between surfaces, as documents: name, size, thickness, speed and method are
// for the test to choose. Each starts without crossings and can be stepped for 10 s and more.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "server/scene/document.h"
#include "tests/overhand.h"

namespace clothlab::test {

using scene::json;

struct ContactOptions {
  int size = 16;             ///< vertices along each side of a sheet
  double thickness = 0.005;  ///< [m], 0.002 to 0.01
  double speed = 1.0;        ///< of what moves, at its fastest [m/s]
  std::string method = "implicit_euler";
  std::string kind = "points";  ///< of self-collision
  double dt = 0.0;              ///< [s]; 0: 0.004, or what the sheets' springs allow an explicit method
};

struct ContactScene {
  std::string name, about;
  std::function<json(const ContactOptions&)> document;
};

/// Sheets are half a metre wide, of a light cotton's density and of soft springs.
namespace contact {

inline constexpr double width = 0.5, density = 0.15, stiffness = 100.0;

inline double spacing(int size) {
  return width / (size - 1);
}

/// Stable under the explicit methods: omega_max is at most sqrt(12 k / m).
inline double time_step(const ContactOptions& options) {
  if (options.dt > 0.0) return options.dt;
  const scene::Method method = scene::method_of(options.method).value_or(scene::Method::implicit_euler);
  if (scene::any_step_is_stable(method)) return 0.004;
  const double finest = spacing(2 * options.size);
  return 0.3 * std::sqrt(density * finest * finest / stiffness);
}

/// `size` vertices a side, centred at `at`, turned by `degrees` about x, y and z.
inline json sheet(const std::string& name, int size, const json& at, const json& degrees = {0, 0, 0},
                  const std::vector<json>& pins = {}) {
  // The grid lies at z from 0 to its height; "edge" pins count from that side.
  return {{"name", name},
          {"mesh", {{"grid", {{"columns", size}, {"rows", size}, {"width", width}, {"height", width}}}}},
          {"transform", {{"translate", at}, {"rotate", degrees}, {"scale", 1.0}}},
          {"mass", {{"area_density", density}}},
          {"material",
           {{"model", "springs"},
            {"structural", stiffness},
            {"shear", stiffness / 2},
            {"bend", stiffness / 50},
            {"damping", 0.005}}},
          {"pins", pins}};
}

/// A swing from home along `axis` that is `speed` fast in its middle.
inline json swing(const json& axis, double amplitude, double speed) {
  const double frequency = speed / (2 * std::numbers::pi * amplitude);
  return {{"oscillate", {{"axis", axis}, {"amplitude", amplitude}, {"frequency", frequency}}}};
}
/// A turn that is `speed` fast at `radius`.
inline json turn(const json& axis, const json& center, double radius, double speed) {
  const double degrees = speed / radius * 180 / std::numbers::pi;
  return {{"spin", {{"axis", axis}, {"center", center}, {"degrees_per_second", degrees}}}};
}
inline json pin(const std::string& at, const json& motion = nullptr) {
  return {{"at", at}, {"motion", motion}};
}
inline std::string last(const std::string& line, int size) {
  return "edge:" + line + ":" + std::to_string(size - 1);
}

inline json collider(const std::string& name, const std::string& kind, const json& shape,
                     const json& motion = nullptr) {
  return {{"name", name}, {kind, shape}, {"friction", 0.3}, {"restitution", 0.0}, {"motion", motion}};
}
inline json floor() {
  return collider("floor", "plane", {{"point", {0, 0, 0}}, {"normal", {0, 1, 0}}});
}

inline json scene_of(const std::string& name, const ContactOptions& options, const std::vector<json>& cloths,
                     const std::vector<json>& colliders = {}) {
  json made{
      {"version", 1},
      {"name", name},
      {"cloths", cloths},
      {"colliders", colliders},
      {"self_collision", {{"thickness", options.thickness}, {"friction", 0.3}}},
      {"air_drag", 0.3},
      {"solver",
       {{"method", options.method}, {"dt", time_step(options)}, {"iterations", 10}, {"tolerance", 1e-4}}}};
  if (options.kind != "points") made["self_collision"]["kind"] = options.kind;
  return made;
}

/// Sheets one above the other from `height` on, each turned a little more, so that no vertices lie in line.
inline std::vector<json> pile(const ContactOptions& options, int layers, double height) {
  std::vector<json> cloths;
  for (int i = 0; i < layers; ++i)
    cloths.push_back(sheet("layer " + std::to_string(i), options.size,
                           {0.003 * i, height + 1.5 * options.thickness * i, -width / 2}, {0, 3 * i, 0}));
  return cloths;
}

inline json twist(const ContactOptions& o) {
  const std::vector<json> pins = {
      pin("edge:column:0", turn({1, 0, 0}, {0, 1, 0}, width / 2, o.speed)),
      pin(last("column", o.size), turn({-1, 0, 0}, {0, 1, 0}, width / 2, o.speed))};
  return scene_of("twist", o, {sheet("cloth", o.size, {0, 1, -width / 2}, {0, 0, 0}, pins)});
}

inline json fold(const ContactOptions& o) {  // one edge is carried over, onto the other one and back
  const double up = 2 * o.thickness;
  const std::vector<json> pins = {pin("edge:row:0"),
                                  pin(last("row", o.size), swing({0, 0.5, -1}, 0.8 * width, o.speed))};
  return scene_of("fold", o, {sheet("cloth", o.size, {0, up, -width / 2}, {0, 0, 0}, pins)}, {floor()});
}

inline json collide(const ContactOptions& o) {  // one sheet is swung through the middle of another one
  const json moving = swing({0, -1, 0}, 0.15, o.speed);
  const std::vector<json> across = {pin("edge:row:0"), pin(last("row", o.size))};
  const std::vector<json> along = {pin("edge:column:0", moving), pin(last("column", o.size), moving)};
  // Each is held outside the other one: along x the moving one is wider.
  json struck = sheet("struck", o.size, {0, 1, -0.6 * width}, {0, 0, 0}, across);
  struck["mesh"]["grid"]["height"] = 1.2 * width;
  json striking = sheet("striking", o.size, {0.004, 1.05, -width / 2}, {0, 2, 0}, along);
  striking["mesh"]["grid"]["width"] = 1.3 * width;
  return scene_of("collide", o, {struck, striking});
}

inline json resolutions(const ContactOptions& o) {  // a coarse sheet between two fine ones, over a ball
  std::vector<json> cloths;
  for (int i = 0; i < 3; ++i)
    cloths.push_back(sheet("sheet " + std::to_string(i), i == 1 ? o.size / 2 : 2 * o.size - 1,
                           {0.002 * i, 0.42 + 2 * o.thickness * i, -width / 2}, {0, 5 * i, 0}));
  return scene_of("resolutions", o, cloths,
                  {floor(), collider("ball", "sphere", {{"center", {0, 0.2, 0}}, {"radius", 0.18}})});
}

inline json ribbon(const ContactOptions& o) {  // an overhand knot, pulled tight and loosened
  const int across = std::max(3, o.size / 4);
  const Ribbon made = overhand_ribbon(0.1, 0.04, 0.04 / (across - 1), across);
  json cloth = sheet("ribbon", o.size, {0, 1, 0});
  json &vertices = cloth["mesh"]["vertices"] = json::array(), &triangles = cloth["mesh"]["triangles"];
  for (const glm::dvec3& v : made.vertices) vertices.push_back({v.x, v.y, v.z});
  triangles = made.triangles;
  cloth["mesh"].erase("grid");
  for (const int end : {-1, 1}) {
    const json motion = swing({end, 0, 0}, 0.5, o.speed);
    for (int i = 0; i < across; ++i)
      cloth["pins"].push_back(
          pin("vertex:" + std::to_string((end < 0 ? 0 : made.rows - 1) * across + i), motion));
  }
  return scene_of("ribbon", o, {cloth});
}

inline json shot(const ContactOptions& o) {  // a sphere into the side of a pile
  const json sphere = {{"center", {-1, 0.1, 0.03}}, {"radius", 0.08}};
  const json motion = {{"linear", {{"velocity", {o.speed, 0, 0}}}}};
  return scene_of("shot", o, pile(o, 4, 0.12), {floor(), collider("ball", "sphere", sphere, motion)});
}

inline json dropped_box(const ContactOptions& o) {  // comes within 3 cm of the floor
  const json box = {{"center", {0, 0.45, 0}}, {"half", {0.1, 0.05, 0.1}}, {"rotate", {0, 20, 0}}};
  return scene_of("dropped_box", o, pile(o, 5, 0.05),
                  {floor(), collider("box", "box", box, swing({0, -1, 0}, 0.37, o.speed))});
}

inline json dragged_pin(const ContactOptions& o) {  // the lowest sheet's middle is drawn up through the pile
  std::vector<json> cloths = pile(o, 4, 0.02);
  cloths[0]["pins"] =
      json::array({pin("corner:" + std::to_string(o.size / 2) + "," + std::to_string(o.size / 2),
                       swing({0.3, 1, 0.2}, 0.4, o.speed))});
  return scene_of("dragged_pin", o, cloths, {floor()});
}

inline json layers(const ContactOptions& o) {  // onto a ball that turns under them
  const json motion = turn({0, 1, 0}, {0, 0.2, 0}, 0.15, o.speed);
  return scene_of("layers", o, pile(o, 3, 0.4),
                  {floor(), collider("ball", "sphere", {{"center", {0, 0.2, 0}}, {"radius", 0.18}}, motion)});
}

inline json slot(const ContactOptions& o) {  // drawn by its middle row into a gap, in four layers and more
  const double half_gap = 2 * o.thickness + 0.01;
  const auto wall = [&](const std::string& name, double side) {
    return collider(
        name, "box",
        {{"center", {0, 0.3, side * (0.2 + half_gap)}}, {"half", {0.4, 0.1, 0.2}}, {"rotate", {0, 0, 0}}});
  };
  std::vector<json> cloths = pile(o, 2, 0.41);
  const std::string middle = "edge:row:" + std::to_string(o.size / 2);
  for (json& cloth : cloths) cloth["transform"]["rotate"] = {0, 0, 0};
  cloths[0]["transform"]["translate"][2] = -width * (o.size / 2) / (o.size - 1);
  cloths[1]["transform"]["translate"][2] = -width * (o.size / 2) / (o.size - 1);
  cloths[0]["pins"] = json::array({pin(middle, swing({0, -1, 0}, 0.35, o.speed))});
  return scene_of("slot", o, cloths, {wall("near", 1), wall("far", -1)});
}

inline json roll(const ContactOptions& o) {  // wound up on a roller
  const double radius = 0.04;
  const json motion = turn({-1, 0, 0}, {0, 1, 0}, radius, o.speed);
  const std::vector<json> pins = {pin("edge:row:0", motion)};
  const json roller = {{"a", {-0.3, 1, 0}}, {"b", {0.3, 1, 0}}, {"radius", radius}};
  // It hangs from the roller's front.
  return scene_of("roll", o, {sheet("cloth", o.size, {0, 1, radius + o.thickness}, {90, 0, 0}, pins)},
                  {collider("roller", "capsule", roller, motion)});
}

inline json crush(const ContactOptions& o) {  // two boxes push a standing sheet together, to 4 cm
  const auto jaw = [&](const std::string& name, double side) {
    return collider(name, "box",
                    {{"center", {side * 0.45, 0.3, 0}}, {"half", {0.1, 0.3, 0.4}}, {"rotate", {0, 0, 0}}},
                    swing({-side, 0, 0}, 0.33, o.speed));
  };
  return scene_of("crush", o, pile(o, 3, 0.05), {floor(), jaw("left", -1), jaw("right", 1)});
}

}  // namespace contact

inline const std::vector<ContactScene>& contact_scenes() {
  static const std::vector<ContactScene> list{
      {"twist", "opposite edges turned against each other without end", contact::twist},
      {"fold", "an edge carried over onto the opposite one, and back", contact::fold},
      {"collide", "a sheet swung against another one, held crosswise", contact::collide},
      {"resolutions", "sheets of different resolution, on each other over a ball", contact::resolutions},
      {"ribbon", "a ribbon through itself: a knot pulled tight and loosened", contact::ribbon},
      {"shot", "a sphere shot into a pile of four", contact::shot},
      {"dropped_box", "a box comes down on a pile of five, again and again", contact::dropped_box},
      {"dragged_pin", "a pin draws the lowest of four sheets up through the others", contact::dragged_pin},
      {"layers", "three layers on a ball that turns", contact::layers},
      {"slot", "two sheets drawn into a narrow slot", contact::slot},
      {"roll", "a sheet wound up on a roller", contact::roll},
      {"crush", "three sheets pushed together by two boxes", contact::crush},
  };
  return list;
}

}  // namespace clothlab::test
