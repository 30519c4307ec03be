// Reads the material of a cloth: springs or a sheet, with numbers of its own or those of a fabric.
#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/scene/fabrics.h"
#include "server/scene/fitted_springs.h"
#include "server/scene/pointer.h"
#include "server/scene/sections.h"

namespace clothlab::scene {

namespace {

/// Reads the numbers of a material. A fabric's are not written into the document, so that another fabric
/// changes them; the numbers that the document has are its own, whatever the fabric.
struct Numbers {
  const Reader& material;
  bool of_fabric;

  bool stays_absent(const std::string& key) const { return of_fabric && !material.has(key); }
  double operator()(const std::string& key, double standard, const Range& range) const {
    return stays_absent(key) ? standard : material.member(key, standard).number(range);
  }
};

/// A member that may be null, which is its default.
std::optional<double> read_optional(const Reader& object, const std::string& key, const Range& range) {
  const Reader member = object.member(key, json(nullptr));
  return member.is_null() ? std::nullopt : std::optional(member.number(range));
}

Springs read_springs(const Reader& material, const Fabric* fabric, double spacing) {
  material.object({"model", "fabric", "structural", "shear", "bend", "damping", "strain_limit"});
  const Springs standard =
      fabric && spacing > 0.0 ? springs_like(fabric->sheet, spacing, fabric->area_density) : Springs{};
  const Numbers number{material, fabric != nullptr};
  return Springs{number("structural", standard.structural, ranges::stiffness),
                 number("shear", standard.shear, ranges::stiffness),
                 number("bend", standard.bend, ranges::stiffness),
                 number("damping", standard.damping, ranges::damping),
                 read_optional(material, "strain_limit", ranges::strain_limit)};
}

/// Bending stiffness: one number for all directions, or one for each of them.
Fem::Bending read_bending(const Reader& bending) {
  if (!bending.is_object()) {
    const double alike = bending.number(ranges::bending);
    return {alike, alike, std::nullopt};
  }
  bending.object({"warp", "weft", "twist"});
  return {bending.member("warp").number(ranges::bending), bending.member("weft").number(ranges::bending),
          read_optional(bending, "twist", ranges::bending)};
}

void check_poisson(const Reader& material, const Fem& fem) {
  if (fem.poisson * fem.poisson < fem.warp / fem.weft) return;
  const std::string found = material.has("poisson")
                                ? compact(fem.poisson)
                                : with_significant_digits(fem.poisson, 6) + ", the fabric's";
  material.member("poisson").fail(found, "below " +
                                             with_significant_digits(std::sqrt(fem.warp / fem.weft), 3) +
                                             ", the square root of warp / weft (or the sheet would gain "
                                             "energy by being stretched)");
}

/// One number for both directions, or one for each.
std::optional<StrainLimit> read_strain_limit(const Reader& material) {
  const Reader limit = material.member("strain_limit", json(nullptr));
  if (limit.is_null()) return std::nullopt;
  if (!limit.is_object()) return StrainLimit(limit.number(ranges::strain_limit));
  limit.object({"warp", "weft"});
  return StrainLimit(limit.member("warp").number(ranges::strain_limit),
                     limit.member("weft").number(ranges::strain_limit));
}

/// The fabric that a material names, or null.
const Fabric* read_fabric_name(const Reader& material) {
  if (!material.has("fabric")) return nullptr;
  const Reader named = material.member("fabric");
  const Result<std::vector<Fabric>>& all = fabrics();
  if (!all) {
    named.fail(all.error().text());
    return nullptr;
  }
  Words names;
  for (const Fabric& fabric : *all) names.push_back(fabric.name);
  const std::string name = named.choice(names);
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &(*all)[static_cast<std::size_t>(found - names.begin())];
}

}  // namespace

Fem read_sheet(const Reader& material, const Fabric* fabric) {
  material.object(
      {"model", "fabric", "warp", "weft", "poisson", "shear", "bending", "damping", "grain", "strain_limit"});
  const Fem standard = fabric ? fabric->sheet : Fem{};
  const Numbers number{material, fabric != nullptr};
  Fem fem;
  fem.warp = number("warp", standard.warp, ranges::modulus);
  fem.weft = number("weft", standard.weft, ranges::modulus);
  fem.poisson = number("poisson", standard.poisson, ranges::poisson);
  check_poisson(material, fem);
  fem.shear = number("shear", standard.shear, ranges::shear_modulus);
  fem.bending = number.stays_absent("bending")
                    ? standard.bending
                    : read_bending(material.member(
                          "bending", json{{"warp", standard.bending.warp}, {"weft", standard.bending.weft}}));
  fem.damping = number("damping", standard.damping, ranges::damping_time);
  fem.grain = material.member("grain", standard.grain).number(ranges::angle);
  fem.strain_limit = read_strain_limit(material);
  return fem;
}

FabricMaterial read_material(const Reader& material, const Mesh& mesh, double scale) {
  if (!material.is_object()) return {read_springs(material, nullptr, 0.0)};
  const Fabric* fabric = read_fabric_name(material);
  const char* standard = material.has("fabric") ? "fem" : "springs";
  const std::string model = material.member("model", standard).choice({"springs", "fem"});
  if (model == "fem") return {read_sheet(material, fabric), fabric};
  return {read_springs(material, fabric, fabric ? scale * grid_spacing(mesh) : 0.0), fabric};
}

}  // namespace clothlab::scene
