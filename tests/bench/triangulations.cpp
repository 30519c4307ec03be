// How far the same square sheet of springs gives way to loads, cut into triangles in several ways and at two
// resolutions. Prints a table: displacement of the sheet's mass at rest over that of the finer grid, with the
// stiffnesses that the program finds, and with the same number for all springs of a kind. Arguments, if any:
// structural, shear and bend [N/m].
#include <cstdio>
#include <cstdlib>
#include <set>

#include "tests/sheets.h"

using namespace clothlab;

namespace {

/// What a mesh would be without sheet_springs.h: `structural` for edges and `bend` for the others.
void make_alike(model::Model& model, const scene::Springs& material) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& corners : model.triangles)
    for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax(corners[i], corners[(i + 1) % 3]));
  for (model::Spring& spring : model.elements.of<elements::Spring>())
    spring.law.stiffness =
        edges.contains({spring.vertices[0], spring.vertices[1]}) ? material.structural : material.bend;
}

void print_table(const scene::Springs& springs, bool alike) {
  constexpr int fine = 24, coarse = 12;
  const std::vector<test::Load> loads = test::loads(9.8);
  std::vector<double> unit;
  for (const test::Load& load : loads)
    unit.push_back(test::yielding(test::sheet_of(test::Cut::grid, fine, springs), load));
  std::printf("%-18s", alike ? "all springs alike" : "as the program");
  for (const test::Load& load : loads) std::printf("%12s", load.name);
  std::printf("\n");
  for (const int cells : {coarse, fine})
    for (const test::Cut cut : test::all_cuts) {
      std::printf("%-15s %2d", test::name_of(cut), cells);
      for (std::size_t i = 0; i < loads.size(); ++i) {
        const double found =
            test::yielding(test::sheet_of(cut, cells, springs), loads[i], [&](model::Model& model) {
              if (alike && cut != test::Cut::grid) make_alike(model, springs);
            });
        std::printf("%12.3f", found / unit[i]);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
}

}  // namespace

int main(int count, char** arguments) {
  const auto number = [&](int at, double otherwise) {
    return count > at ? std::atof(arguments[at]) : otherwise;
  };
  const scene::Springs springs{number(1, 200.0), number(2, 100.0), number(3, 20.0), 0.0};
  std::printf("structural %g, shear %g, bend %g N/m; 0.2 kg/m^2 under 9.8 m/s^2\n", springs.structural,
              springs.shear, springs.bend);
  for (const bool alike : {false, true}) print_table(springs, alike);
}
