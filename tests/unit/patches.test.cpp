// Patches of vertices, on grids, on a tube and over several cloths.
#include "server/model/patches.h"

#include <algorithm>
#include <glm/common.hpp>
#include <map>

#include "tests/catch.h"

using namespace clothlab;

namespace {

model::Model model_of(const std::vector<scene::Grid>& grids) {
  scene::Scene scene;
  for (const scene::Grid& grid : grids) scene.cloths.emplace_back().mesh = grid;
  auto built = model::build(scene);
  REQUIRE(built);
  return std::move(*built);
}

/// The vertices of each patch.
std::vector<std::vector<std::uint32_t>> members(const model::Model& model, std::uint32_t count) {
  const std::vector<std::uint32_t> patch_of = model::patches(model, count);
  REQUIRE(patch_of.size() == model.vertex_count());
  std::vector<std::vector<std::uint32_t>> of_patch(count);
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i) of_patch.at(patch_of[i]).push_back(i);
  return of_patch;
}

}  // namespace

TEST_CASE("patches of a cloth differ in size by a vertex for each halving, and none is empty") {
  const model::Model model = model_of({scene::Grid{25, 25, 1.0, 1.0}});
  for (const std::uint32_t count : {1U, 2U, 7U, 31U, 48U, 625U}) {
    std::size_t least = model.vertex_count(), most = 0;
    for (const auto& patch : members(model, count)) {
      least = std::min(least, patch.size());
      most = std::max(most, patch.size());
    }
    INFO(count << " patches of " << least << " to " << most << " vertices");
    CHECK(least >= 1);
    CHECK(most - least <= 6);  // at most six halvings make 48 patches
  }
}

TEST_CASE("patches of a square are compact, and those of a strip lie one after another") {
  const model::Model square = model_of({scene::Grid{16, 16, 1.5, 1.5}});
  for (const auto& patch : members(square, 16)) {
    glm::dvec3 low(1e9), high(-1e9);
    for (const std::uint32_t i : patch) {
      low = glm::min(low, square.rest_position[i]);
      high = glm::max(high, square.rest_position[i]);
    }
    CHECK(patch.size() == 16);
    CHECK(std::max(high.x - low.x, high.z - low.z) == Approx(0.3));  // 4 x 4 vertices, 0.1 m apart
  }
  const model::Model strip = model_of({scene::Grid{2, 60, 0.01, 1.0}});
  for (const auto& patch : members(strip, 6)) {
    CHECK(patch.size() == 20);
    const auto [low, high] = std::minmax_element(patch.begin(), patch.end());
    CHECK(*high - *low == 19);
  }
}

TEST_CASE("patches keep cloths apart while there are enough of them") {
  const model::Model model = model_of({{3, 3, 1.0, 1.0}, {20, 20, 1.0, 1.0}, {4, 4, 1.0, 1.0}});
  for (const std::uint32_t count : {3U, 10U, 48U}) {
    std::map<std::uint32_t, std::size_t> of_cloth;
    for (const auto& patch : members(model, count)) {
      REQUIRE(!patch.empty());
      const std::uint32_t cloth = model.vertex_cloth[patch.front()];
      ++of_cloth[cloth];
      for (const std::uint32_t i : patch) CHECK(model.vertex_cloth[i] == cloth);
    }
    CHECK(of_cloth.size() == 3);
    if (count == 48) CHECK(of_cloth[1] > 40);  // in proportion: 400 of 425 vertices
  }
  for (const auto& patch : members(model, 2)) CHECK(!patch.empty());
}
