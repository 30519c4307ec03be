// The order of patches in which their matrix has a factor with few entries.
#include "server/model/dissection.h"

#include <algorithm>

#include "tests/catch.h"

using namespace clothlab;

namespace {

/// A grid of parts, each a neighbour of the eight around it, row after row.
std::vector<std::vector<std::uint32_t>> grid(std::uint32_t side) {
  std::vector<std::vector<std::uint32_t>> neighbours(std::size_t{side} * side);
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, side - 1); ++v)
        for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, side - 1); ++u)
          if (u != x || v != y) neighbours[y * side + x].push_back(v * side + u);
  return neighbours;
}

/// The number of pairs for which the factor has room, each part with itself included.
std::size_t check(const std::vector<std::vector<std::uint32_t>>& neighbours) {
  const model::Dissection made = model::dissect(neighbours);
  std::vector<std::uint32_t> sorted = made.places;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t place = 0; place < sorted.size(); ++place) CHECK(sorted[place] == place);

  std::vector<model::Dissection::Group> group_of;
  std::size_t room = 0;
  for (std::size_t k = 0; k < made.groups.size(); ++k) {
    const model::Dissection::Group& group = made.groups[k];
    CHECK(group.begin == group_of.size());
    CHECK(group.first <= group.begin);
    CHECK(group.begin < group.end);
    group_of.insert(group_of.end(), group.end - group.begin, group);
    room += std::size_t{group.end - group.begin} * (group.end - group.first);
    if (group.parent < 0) continue;
    REQUIRE(group.parent > static_cast<std::int32_t>(k));
    CHECK(made.groups.at(static_cast<std::size_t>(group.parent)).first <= group.first);
  }
  REQUIRE(group_of.size() == neighbours.size());
  for (std::size_t part = 0; part < neighbours.size(); ++part)
    for (const std::uint32_t other : neighbours[part]) {
      const std::uint32_t low = std::min(made.places[part], made.places[other]);
      CHECK(group_of[std::max(made.places[part], made.places[other])].first <= low);
    }
  return room;
}

}  // namespace

TEST_CASE("a dissection has room for all neighbours, and in a grid for a share of all pairs") {
  CHECK(check(grid(1)) == 1);
  CHECK(check(grid(2)) == 4 * 4);
  CHECK(check(grid(8)) < 64 * 64 / 2);
  CHECK(check(grid(11)) < 121 * 121 / 3);
}

TEST_CASE("a dissection of parts without neighbours, of a row and of all with all") {
  CHECK(check(std::vector<std::vector<std::uint32_t>>(16)) == 16 / 4 * 16);
  std::vector<std::vector<std::uint32_t>> row(64);
  for (std::uint32_t k = 0; k + 1 < row.size(); ++k) {
    row[k].push_back(k + 1);
    row[k + 1].push_back(k);
  }
  CHECK(check(row) < 64 * 9);  // a part is under one cut of each of five divisions, and in a rest of four
  std::vector<std::vector<std::uint32_t>> all(9);
  for (std::uint32_t a = 0; a < all.size(); ++a)
    for (std::uint32_t b = 0; b < all.size(); ++b)
      if (a != b) all[a].push_back(b);
  CHECK(check(all) < 9 * 9);  // full below the diagonal
}
