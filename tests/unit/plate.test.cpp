// The plate (server/model/plate.h): quadratic surfaces have their exact energy on any mesh, and a rigid
// motion has none.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <utility>

#include "server/model/plate.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec2;
using glm::dvec3;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
constexpr model::PlateStiffness stiffness{3e-5, 7e-5, 2e-5};

/// A flat mesh of the unit square, counter-clockwise.
struct Mesh {
  std::vector<dvec2> place;
  Triangles triangles;
  std::vector<model::FlatTriangle> flat() const {
    std::vector<model::FlatTriangle> result;
    for (const auto& [a, b, c] : triangles) result.push_back({place[a], place[b], place[c]});
    return result;
  }
};

enum class Diagonals { one_way, other_way, alternating, random };

/// A grid of `cells` x `cells`, its inner vertices moved by up to `shift` of a cell.
Mesh grid(int cells, Diagonals diagonals, double shift = 0.0) {
  Mesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> either(-shift, shift);
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column) {
      const bool inner = row > 0 && row < cells && column > 0 && column < cells;
      const double x = column + (inner ? either(random) : 0.0), y = row + (inner ? either(random) : 0.0);
      mesh.place.emplace_back(x / cells, y / cells);
    }
  const auto at = [&](int column, int row) { return static_cast<std::uint32_t>(row * (cells + 1) + column); };
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const auto a = at(column, row), b = at(column + 1, row), c = at(column + 1, row + 1),
                 d = at(column, row + 1);
      const bool one = diagonals == Diagonals::one_way ||
                       (diagonals == Diagonals::alternating && (row + column) % 2) ||
                       (diagonals == Diagonals::random && random() % 2);
      if (one) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  return mesh;
}

std::vector<Mesh> meshes() {
  return {grid(8, Diagonals::one_way), grid(8, Diagonals::other_way), grid(8, Diagonals::alternating),
          grid(8, Diagonals::random, 0.3)};
}

double energy(const model::CurvatureRows& rows, const std::vector<dvec3>& x) {
  double sum = 0.0;
  for (const auto& row : rows.row) {
    dvec3 value(0.0);
    for (std::size_t k = 0; k < row.size(); ++k) value += row[k] * x[rows.vertices[k]];
    sum += 0.5 * glm::dot(value, value);
  }
  return sum;
}

double energy(const std::vector<model::BendingPair>& pairs, const std::vector<dvec3>& x) {
  double sum = 0.0;
  for (const model::BendingPair& pair : pairs) {
    const dvec3 d = x[pair.a] - x[pair.b];
    sum += 0.5 * pair.stiffness * glm::dot(d, d);
  }
  return sum;
}

double area(const model::FlatTriangle& t) {
  const dvec2 a = t[1] - t[0], b = t[2] - t[0];
  return 0.5 * (a.x * b.y - a.y * b.x);
}

}  // namespace

TEST_CASE("cylinders, saddles and any quadratic surface have their exact bending energy on every mesh") {
  for (const Mesh& mesh : meshes()) {
    const auto flat = mesh.flat();
    const auto rows =
        model::curvature_rows(mesh.triangles, flat, std::vector<char>(mesh.place.size(), 0), stiffness);
    REQUIRE(rows.size() == mesh.triangles.size());
    // Curvatures along x, along y and twist: cylinders along, across and at an angle, a saddle, a bowl.
    for (const dvec3 k :
         {dvec3(2, 0, 0), dvec3(0, 2, 0), dvec3(0, 0, 2), dvec3(1, 1, -1), dvec3(1, -1, 0), dvec3(1, 1, 0)}) {
      std::vector<dvec3> x;
      for (const dvec2& p : mesh.place)
        x.emplace_back(p.x, p.y, 0.5 * (k.x * p.x * p.x + k.y * p.y * p.y) + k.z * p.x * p.y);
      int inner = 0;
      for (std::size_t t = 0; t < rows.size(); ++t) {
        // Two cells from the edge, where no slope is free and no patch is short of vertices.
        bool far = true;
        for (const dvec2& corner : flat[t])
          far = far && corner.x > 0.25 && corner.x < 0.75 && corner.y > 0.25 && corner.y < 0.75;
        if (!far) continue;
        ++inner;
        const double exact =
            0.5 * area(flat[t]) *
            (stiffness.warp * k.x * k.x + stiffness.weft * k.y * k.y + 4 * stiffness.twist * k.z * k.z);
        CHECK(energy(rows[t], x) == Approx(exact).epsilon(1e-9));
      }
      CHECK(inner > 5);
    }
  }
}

TEST_CASE("the pairs of a plate have the energy of its triangles, whatever the shape") {
  std::mt19937 random(2);
  std::normal_distribution<double> around(0.0, 0.3);
  for (const Mesh& mesh : meshes()) {
    std::vector<dvec3> x;
    for (const dvec2& p : mesh.place)
      x.emplace_back(p.x + around(random), p.y + around(random), around(random));
    for (const bool clamped : {false, true}) {
      std::vector<char> held(mesh.place.size(), 0);
      for (std::size_t i = 0; clamped && i < 18; ++i) held[i] = 1;  // the first two rows of nine
      double sum = 0.0;
      for (const auto& rows : model::curvature_rows(mesh.triangles, mesh.flat(), held, stiffness))
        sum += energy(rows, x);
      const auto pairs = model::bending_pairs(mesh.triangles, mesh.flat(), held, stiffness);
      CHECK(energy(pairs, x) == Approx(sum).epsilon(1e-9));
      for (std::size_t i = 1; i < pairs.size(); ++i)
        CHECK(std::pair(pairs[i - 1].a, pairs[i - 1].b) < std::pair(pairs[i].a, pairs[i].b));
    }
  }
}

TEST_CASE("a flat sheet has no bending energy wherever it is turned, and none from an even stretch") {
  for (const Mesh& mesh : meshes()) {
    const auto pairs =
        model::bending_pairs(mesh.triangles, mesh.flat(), std::vector<char>(mesh.place.size(), 0), stiffness);
    std::vector<dvec3> turned, bent;
    for (const dvec2& p : mesh.place) {
      turned.push_back(dvec3(5.0, -3.0, 1.0) + 1.2 * p.x * dvec3(0, 0.6, 0.8) + p.y * dvec3(1, 0, 0));
      bent.emplace_back(p.x, p.y, p.x * p.x);
    }
    // Rounding: the pairs' terms, of both signs, are some thousand times the energy that bending by 2/m
    // costs.
    CHECK(std::abs(energy(pairs, turned)) < 1e-9 * energy(pairs, bent));
  }
}

TEST_CASE(
    "on a grid that bends alike in all directions a vertex is paired with 12 others: the 13-point plate") {
  const Mesh mesh = grid(12, Diagonals::one_way);
  const double alike = 1e-5;
  const auto pairs = model::bending_pairs(
      mesh.triangles, mesh.flat(), std::vector<char>(mesh.place.size(), 0), {alike, alike, 0.5 * alike});
  const std::uint32_t middle = 6 * 13 + 6;
  double along = 0.0, diagonal = 0.0, second = 0.0;
  int others = 0;
  for (const model::BendingPair& pair : pairs) {
    if (pair.a != middle && pair.b != middle) continue;
    ++others;
    const std::uint32_t other = pair.a == middle ? pair.b : pair.a;
    if (other == middle + 1) along = pair.stiffness;
    if (other == middle + 14) diagonal = pair.stiffness;
    if (other == middle + 2) second = pair.stiffness;
  }
  CHECK(others == 12);
  // The biharmonic's stencil: B/h^2 times 8, -2, -1 (the pairs' k is the negative of the matrix's entry).
  const double unit = alike * 12 * 12;
  CHECK(along == Approx(8 * unit).epsilon(1e-9));
  CHECK(diagonal == Approx(-2 * unit).epsilon(1e-9));
  CHECK(second == Approx(-1 * unit).epsilon(1e-9));
}
