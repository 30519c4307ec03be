#include <algorithm>
#include <cmath>
#include <type_traits>

#include "server/scene/fabrics.h"
#include "server/scene/sections.h"

namespace clothlab::scene {

std::string default_name(const char* kind, std::size_t index) {
  std::string name = kind;
  if (index > 0) name.append("-").append(std::to_string(index + 1));
  return name;
}

namespace {

Mass read_mass(const Reader& mass) {
  mass.object({"per_vertex", "area_density"});
  const std::string kind = mass.exactly_one({"per_vertex", "area_density"});
  if (kind == "area_density")
    return Mass{Mass::Kind::area_density, mass.member(kind).number(ranges::area_density)};
  return Mass{Mass::Kind::per_vertex, mass.member("per_vertex").number(ranges::mass_per_vertex)};
}

Motion placed_at(const dvec3& place, const Motion& motion) {
  Placed placed{place, {}};
  std::visit(
      [&](const auto& kind) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(kind)>, Placed>) placed.then = kind;
      },
      motion);
  return placed;
}

std::vector<Pin> read_pins(const Reader& pins, const Mesh& mesh) {
  std::vector<Pin> result(pins.array(0, max_pins));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader pin = pins.element(i);
    pin.object({"at", "place", "motion"});
    result[i] = Pin{read_at(pin.member("at"), mesh), read_motion(pin.member("motion", json(nullptr)))};
    if (!pin.has("place")) continue;
    const Reader place = pin.member("place");
    if (std::holds_alternative<AtCorner>(result[i].at) || std::holds_alternative<AtVertex>(result[i].at))
      result[i].motion = placed_at(place.vector(ranges::position), result[i].motion);
    else
      place.fail(
          "\"at\" of one vertex, \"corner:COLUMN,ROW\" or \"vertex:N\": several cannot be at one place");
  }
  return result;
}

std::vector<Weight> read_weights(const Reader& weights, const Mesh& mesh) {
  std::vector<Weight> result(weights.array(0, max_weights));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader weight = weights.element(i);
    weight.object({"at", "mass"});
    result[i] = Weight{read_at(weight.member("at"), mesh), weight.member("mass").number(ranges::weight)};
  }
  return result;
}

Start read_start(const Reader& start) {
  if (start.is_null()) return std::monostate{};
  const Words kinds = {"scatter", "scale", "dress"};
  start.object(kinds);
  const std::string kind = start.exactly_one(kinds);
  if (kind == "dress") return Dress{start.member("dress").number(ranges::dress)};
  if (kind == "scale") return Stretch{start.member("scale").vector(ranges::start_scale)};
  const Reader scatter = start.member("scatter");
  scatter.object({"size", "seed"});
  return Scatter{scatter.member("size").number(ranges::length),
                 static_cast<std::uint32_t>(scatter.member("seed", 1).integer(ranges::seed))};
}

std::string read_color(const Reader& color) {
  const std::string allowed = "a color as #rrggbb in hexadecimal digits";
  const std::string text = color.string(allowed);
  const bool digits = std::all_of(text.begin() + (text.empty() ? 0 : 1), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  });
  if (text.size() != 7 || text[0] != '#' || !digits) color.fail(allowed);
  return text;
}

}  // namespace

Cloth read_cloth(const Reader& cloth, std::size_t index, const Assets* assets) {
  cloth.object(
      {"name", "mesh", "transform", "mass", "material", "pins", "weights", "start", "color", "texture"});
  Cloth result;
  result.name = cloth.member("name", default_name("cloth", index)).name();
  result.mesh = read_mesh(cloth.member("mesh"), assets);
  result.transform = read_transform(cloth.member("transform", json::object()));
  const FabricMaterial made =
      read_material(cloth.member("material", json::object()), result.mesh, result.transform.scale);
  result.material = made.material;
  // A fabric's own density is not written into the document, so that it changes with the fabric.
  result.mass = made.fabric && !cloth.has("mass")
                    ? Mass{Mass::Kind::area_density, made.fabric->area_density}
                    : read_mass(cloth.member("mass", json{{"per_vertex", 0.1}}));
  result.pins = read_pins(cloth.member("pins", json::array()), result.mesh);
  result.weights = read_weights(cloth.member("weights", json::array()), result.mesh);
  result.start = read_start(cloth.member("start", json(nullptr)));
  result.color = read_color(cloth.member("color", "#b03a2e"));
  result.texture = cloth.member("texture", "weave").choice({"weave", "checker", "stripes", "plain"});
  return result;
}

}  // namespace clothlab::scene
