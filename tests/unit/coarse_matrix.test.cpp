// The coarse level of implicit Euler's preconditioner: the modes of the patches, and the matrix that they
// have.
#include "server/sim/coarse_matrix.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "server/model/patches.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec3;
using Vectors = std::vector<dvec3>;

namespace {

struct Coarse {
  scene::Scene scene;
  model::Model model;
  std::vector<std::uint32_t> patch_of;
  sim::CoarseMatrix matrix;
  std::vector<glm::vec4> position;
};

/// A number in [-1, 1) that depends on `key` without order.
double scattered(std::size_t key) {
  const double s = std::sin(12.9898 * static_cast<double>(key + 1)) * 43758.5453;
  return 2.0 * (s - std::floor(s)) - 1.0;
}

/// A bent, stretched sheet pinned at a corner, with `count` patches, any two of which may be coupled.
Coarse coarse(const scene::Material& material, std::uint32_t side, std::uint32_t count) {
  scene::Scene scene;
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{static_cast<int>(side), static_cast<int>(side), 1.0, 1.0};
  cloth.material = material;
  cloth.pins.emplace_back().at = scene::AtCorner{0, 0};
  scene.air_drag = 0.5;
  scene.solver.method = scene::Method::implicit_euler;
  scene.solver.dt = 0.01;
  auto built = model::build(scene);
  REQUIRE(built);
  std::vector<std::uint32_t> patch_of = model::patches(*built, count);
  std::vector<std::vector<std::uint32_t>> all(count);
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = 0; b < count; ++b)
      if (a != b) all[a].push_back(b);
  const model::Dissection dissection = model::dissect(all);
  for (std::uint32_t& patch : patch_of) patch = dissection.places[patch];
  Coarse made{scene, std::move(*built), patch_of, sim::CoarseMatrix(dissection, patch_of), {}};
  made.matrix.set_parameters(made.model, scene);
  for (std::uint32_t i = 0; i < made.model.vertex_count(); ++i) {
    const dvec3 x = 1.05 * made.model.rest_position[i];
    const bool pinned = made.model.pin_motion[i] != model::not_pinned;
    made.position.emplace_back(x.x, x.y + 0.2 * x.x * x.x, x.z, pinned ? 0.0 : 1.0 / made.model.mass[i]);
  }
  return made;
}

/// The motion of all vertices that `unknowns` of the patches are.
Vectors motion(const Coarse& of, const std::vector<double>& unknowns) {
  Vectors moved;
  for (std::uint32_t i = 0; i < of.model.vertex_count(); ++i) {
    dvec3 sum(0.0);
    for (std::size_t mode = 0; mode < sim::patch_modes; ++mode)
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] +=
            of.matrix.shares()[i][mode] *
            unknowns[sim::patch_unknowns * of.patch_of[i] + 3 * mode + static_cast<std::size_t>(axis)];
    moved.push_back(sum);
  }
  return moved;
}

/// The step's matrix times a motion, as the kernels have it.
Vectors product(const Coarse& of, const Vectors& moved) {
  const double dt = of.scene.solver.dt;
  Vectors result(moved.size(), dvec3(0.0));
  for (std::uint32_t i = 0; i < moved.size(); ++i)
    if (of.position[i].w > 0.0F) result[i] = moved[i] * ((1.0 + dt * of.scene.air_drag) / of.position[i].w);
  model::each_element(of.model.elements, [&](const auto& element) {
    for (std::size_t corner = 0; corner < element.corners; ++corner) {
      const std::uint32_t here = element.vertices[corner];
      const auto place = model::edges(element, corner, [&](std::uint32_t other) {
        return dvec3(of.position[here]) - dvec3(of.position[other]);
      });
      const auto matrix =
          elements::step_matrix(elements::element_hessian(law_at(element, corner), place), dt);
      result[here] += elements::matrix_product(matrix, model::edges(element, corner, moved));
    }
  });
  return result;
}

/// The parts of a vector of all vertices in the modes of the patches.
std::vector<double> parts(const Coarse& of, const Vectors& vectors) {
  std::vector<double> sums(sim::patch_unknowns * of.matrix.matrix().dissection().places.size(), 0.0);
  for (std::uint32_t i = 0; i < vectors.size(); ++i)
    for (std::size_t mode = 0; mode < sim::patch_modes; ++mode)
      for (int axis = 0; axis < 3; ++axis)
        sums[sim::patch_unknowns * of.patch_of[i] + 3 * mode + static_cast<std::size_t>(axis)] +=
            of.matrix.shares()[i][mode] * vectors[i][axis];
  return sums;
}

/// W^T W times a vector.
std::vector<double> solved(const sim::PatchMatrix& matrix, const std::vector<double>& right) {
  const std::vector<std::vector<double>> factor = matrix.inverse_factor();
  REQUIRE(factor.size() == matrix.dissection().groups.size());
  std::vector<double> solution(right.size(), 0.0);
  for (std::size_t k = 0; k < factor.size(); ++k) {
    const model::Dissection::Group& group = matrix.dissection().groups[k];
    const std::size_t first = sim::patch_unknowns * group.first, end = sim::patch_unknowns * group.end;
    const std::size_t rows = sim::patch_unknowns * (group.end - group.begin);
    for (std::size_t row = 0; row < rows; ++row) {
      double sum = 0.0;
      for (std::size_t c = first; c < end; ++c) sum += factor[k][(c - first) * rows + row] * right[c];
      for (std::size_t c = first; c < end; ++c) solution[c] += factor[k][(c - first) * rows + row] * sum;
    }
  }
  return solution;
}

}  // namespace

TEST_CASE("patches move as the step's matrix says: its coarse matrix is that of their modes") {
  scene::Springs springs;
  springs.damping = 0.1;
  for (const scene::Material& material : {scene::Material(scene::Fem{}), scene::Material(springs)}) {
    Coarse of = coarse(material, 11, 6);
    of.matrix.make(of.position, {});
    std::vector<double> unknowns(6 * sim::patch_unknowns);
    for (std::size_t k = 0; k < unknowns.size(); ++k) unknowns[k] = scattered(k);
    const std::vector<double> found =
        solved(of.matrix.matrix(), parts(of, product(of, motion(of, unknowns))));
    for (std::size_t k = 0; k < unknowns.size(); ++k) CHECK(found[k] == Approx(unknowns[k]).margin(1e-6));
  }
}

TEST_CASE("what couples two vertices beside elements has its place in the coarse matrix") {
  Coarse of = coarse(scene::Springs{}, 9, 4);
  const glm::dmat3 part = glm::outerProduct(dvec3(0.0, 3.0, 4.0), dvec3(0.0, 3.0, 4.0));
  const std::uint32_t one = 20, other = 60;
  REQUIRE(of.patch_of[one] != of.patch_of[other]);
  of.matrix.make(of.position, {});
  of.matrix.add(one, one, part);
  of.matrix.add(other, other, part);
  of.matrix.add(one, other, -part);
  of.matrix.add(other, one, -part);
  std::vector<double> unknowns(4 * sim::patch_unknowns);
  for (std::size_t k = 0; k < unknowns.size(); ++k) unknowns[k] = scattered(k);
  const Vectors moved = motion(of, unknowns);
  Vectors felt = product(of, moved);
  felt[one] += part * (moved[one] - moved[other]);
  felt[other] += part * (moved[other] - moved[one]);
  const std::vector<double> found = solved(of.matrix.matrix(), parts(of, felt));
  for (std::size_t k = 0; k < unknowns.size(); ++k) CHECK(found[k] == Approx(unknowns[k]).margin(1e-6));
}

TEST_CASE("a motion that a collider prevents stretches nothing in the coarse matrix") {
  Coarse of = coarse(scene::Springs{}, 9, 4);
  std::vector<glm::vec4> constraint(of.position.size(), glm::vec4(0.0F));
  constraint[30] = glm::vec4(0.6F, 0.8F, 0.0F, 0.0F);
  constraint[40] = glm::vec4(0.0F, 1.0F, 0.0F, -1.0F);  // it sticks
  const auto filtered = [&](Vectors vectors) {
    const dvec3 normal(constraint[30]);
    vectors[30] -= normal * glm::dot(normal, vectors[30]);
    vectors[40] = dvec3(0.0);
    return vectors;
  };
  of.matrix.make(of.position, constraint);
  std::vector<double> unknowns(4 * sim::patch_unknowns);
  for (std::size_t k = 0; k < unknowns.size(); ++k) unknowns[k] = scattered(k);
  const Vectors moved = motion(of, unknowns), kept = filtered(moved);
  Vectors felt = filtered(product(of, kept));
  for (const std::size_t i : {30U, 40U})  // masses count in any direction
    felt[i] += (moved[i] - kept[i]) * ((1.0 + of.scene.solver.dt * of.scene.air_drag) / of.position[i].w);
  const std::vector<double> found = solved(of.matrix.matrix(), parts(of, felt));
  for (std::size_t k = 0; k < unknowns.size(); ++k) CHECK(found[k] == Approx(unknowns[k]).margin(1e-6));
}

TEST_CASE("a patch has the modes that its vertices tell apart, and its matrix stays definite") {
  for (const std::uint32_t count : {1U, 3U, 16U, 25U}) {  // of a vertex or two: rows, and single ones
    Coarse of = coarse(scene::Springs{}, 5, count);
    of.matrix.make(of.position, {});
    CHECK(!of.matrix.matrix().inverse_factor().empty());
    if (count != 25) continue;
    for (std::uint32_t i = 0; i < of.model.vertex_count(); ++i) {
      const bool pinned = of.model.pin_motion[i] != model::not_pinned;
      CHECK(of.matrix.shares()[i] == sim::Shares{pinned ? 0.0 : 1.0, 0.0, 0.0});
    }
  }
}

TEST_CASE("a matrix that is not definite or not finite has no factor") {
  Coarse of = coarse(scene::Springs{}, 5, 3);
  of.matrix.make(of.position, {});
  of.matrix.add(7, 7, glm::dmat3(-1e6));
  CHECK(of.matrix.matrix().inverse_factor().empty());
  of.position[7].y = NAN;
  of.matrix.make(of.position, {});
  CHECK(of.matrix.matrix().inverse_factor().empty());
}
