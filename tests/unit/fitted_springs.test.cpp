// Springs that act as a sheet of finite elements.
#include "server/scene/fitted_springs.h"

#include <algorithm>
#include <cmath>

#include "server/model/model.h"
#include "server/scene/fabrics.h"
#include "server/scene/ranges.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

constexpr int count = 9;  ///< vertices along a side

/// A square of springs, and its energy a square metre [J/m^2] when its vertices are moved.
struct Sample {
  scene::Scene scene;
  model::Model model;
  double spacing;

  Sample(const scene::Springs& springs, double edge) : scene(test::sheet(count, count)), spacing(edge) {
    scene.cloths[0].mesh = scene::Grid{count, count, (count - 1) * edge, (count - 1) * edge};
    scene.cloths[0].material = springs;
    model = *model::build(scene);
  }

  /// Energy [J/m^2] of the springs of one cell in the middle, whose ends go where `move` says.
  template <class Move>
  double energy(Move move) const {
    std::vector<glm::dvec3> place;
    for (const glm::dvec3& rest : model.rest_position) place.push_back(move(rest - glm::dvec3(0, 1, 0)));
    double sum = 0.0;
    for (const auto& spring : model.elements.of<elements::Spring>()) {
      const auto [a, b] = spring.vertices;
      if (std::min(a, b) != middle_of(a, b)) continue;
      sum += elements::element_energy(spring.law, {{place[a] - place[b]}});
    }
    return sum / (spacing * spacing);
  }

 private:
  /// The lower vertex of a spring, if the spring is one of the middle cell's.
  static std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t low = std::min(a, b), high = std::max(a, b);
    constexpr std::uint32_t middle = (count / 2) * count + count / 2;
    if (high - low == count - 1) return low == middle + 1 ? low : low + 1;  // the cell's other diagonal
    return low == middle ? low : low + 1;
  }
};

/// Force a metre of width [N/m] on a strip pulled by `strain` along x and free to narrow along z, over the
/// strain.
double tension(const Sample& sample, double strain) {
  const auto narrowest = [&](double stretch) {
    double low = -strain, high = strain;  // golden section: the energy has one minimum
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    const auto at = [&](double side) {
      return sample.energy(
          [&](glm::dvec3 p) { return glm::dvec3(p.x * (1 + stretch), 0, p.z * (1 + side)); });
    };
    for (int i = 0; i < 80; ++i) {
      const double a = high - golden * (high - low), b = low + golden * (high - low);
      (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
    }
    return at(0.5 * (low + high));
  };
  return 2.0 * narrowest(strain) / (strain * strain);
}

double slant(const Sample& sample, double angle) {
  return 2.0 * sample.energy([&](glm::dvec3 p) { return glm::dvec3(p.x + angle * p.z, 0, p.z); }) /
         (angle * angle);
}

/// Energy when bent along x to a cylinder that keeps the vertices' distances.
double bent(const Sample& sample, double curvature) {
  const double turn = curvature * sample.spacing, radius = 0.5 * sample.spacing / std::sin(0.5 * turn);
  return sample.energy([&](glm::dvec3 p) {
    const double angle = turn * p.x / sample.spacing;
    return glm::dvec3(radius * std::sin(angle), radius * std::cos(angle), p.z);
  });
}

constexpr double small = 1e-4;  ///< a strain; what follows agrees to first order in it

}  // namespace

TEST_CASE("a strip of the fitted springs is as stiff as the sheet along warp and weft on average") {
  for (const scene::Fabric& fabric : *scene::fabrics()) {
    INFO(fabric.name);
    const Sample sample(scene::springs_like(fabric.sheet, 0.02, fabric.area_density), 0.02);
    const double wanted = std::sqrt(fabric.sheet.warp * fabric.sheet.weft);
    CHECK(tension(sample, small) == Approx(wanted).epsilon(10 * small));
  }
}

TEST_CASE("the fitted springs slant as the sheet does") {
  for (const scene::Fabric& fabric : *scene::fabrics()) {
    INFO(fabric.name);
    const Sample sample(scene::springs_like(fabric.sheet, 0.02, fabric.area_density), 0.02);
    // Structural springs lengthen at second order in the angle: their energy is of fourth order.
    const double second_order = fabric.sheet.weft / fabric.sheet.shear * small * small;
    CHECK(slant(sample, small) == Approx(fabric.sheet.shear).epsilon(10 * small + second_order));
  }
}

TEST_CASE(
    "bent as it folds under its own weight the fitted springs' energy is the sheet's, where the grid lets "
    "it") {
  for (const scene::Fabric& fabric : *scene::fabrics()) {
    INFO(fabric.name);
    constexpr double spacing = 0.02;
    const scene::Springs springs = scene::springs_like(fabric.sheet, spacing, fabric.area_density);
    const double bending = std::sqrt(fabric.sheet.bending.warp * fabric.sheet.bending.weft);
    const double fold = std::cbrt(bending / (9.8 * fabric.area_density)),
                 curvature = std::min(1 / fold, 1 / spacing);
    const double wanted = 0.5 * bending * curvature * curvature,
                 energy = bent(Sample(springs, spacing), curvature);
    const bool soft = springs.bend < (springs.structural + 4 * springs.bend) / 8.001;  // less than its most
    if (soft)
      CHECK(energy == Approx(wanted).epsilon(1e-9));
    else
      CHECK(energy < wanted);
  }
}

TEST_CASE("no fitted spring is negative, whatever the sheet and the grid, and each is allowed in a scene") {
  const double stiffness[] = {0.0, 1e-3, 1.0, 1e9}, bending[] = {0.0, 1e-9, 1e-3, 1e6};
  for (const double warp : stiffness)
    for (const double shear : stiffness)
      for (const double bend : bending)
        for (const double spacing : {1e-6, 1e-2, 1e6}) {
          if (warp == 0.0) continue;
          scene::Fem sheet;
          sheet.warp = sheet.weft = warp;
          sheet.shear = shear;
          sheet.bending = {bend, bend, std::nullopt};
          sheet.damping = 10;
          const scene::Springs springs = scene::springs_like(sheet, spacing, 1e-3);
          INFO(warp << " " << shear << " " << bend << " " << spacing);
          for (const double k : {springs.structural, springs.shear, springs.bend}) {
            CHECK(k >= 0.0);
            CHECK(k <= scene::ranges::stiffness.maximum);
          }
          CHECK(springs.damping >= 0.0);
        }
}

TEST_CASE("under a fabric's name springs are fitted to the distance of the vertices") {
  const auto springs = [](int columns, double width, double scale) {
    scene::json cloth = {
        {"mesh", {{"grid", {{"columns", columns}, {"rows", columns}, {"width", width}, {"height", width}}}}},
        {"transform", {{"scale", scale}}},
        {"material", {{"model", "springs"}, {"fabric", "canvas"}}}};
    return scene::validate({{"version", 1}, {"cloths", {cloth}}})->scene.cloths[0].springs();
  };
  const scene::Fabric canvas = (*scene::fabrics())[3];
  REQUIRE(canvas.name == "canvas");
  CHECK(springs(51, 1.0, 1.0) == scene::springs_like(canvas.sheet, 0.02, canvas.area_density));
  CHECK(springs(51, 0.5, 2.0).bend == Approx(springs(51, 1.0, 1.0).bend).epsilon(1e-12));
  CHECK(springs(26, 1.0, 1.0).bend < springs(51, 1.0, 1.0).bend);
}
