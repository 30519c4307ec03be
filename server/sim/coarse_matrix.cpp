#include "server/sim/coarse_matrix.h"

#include <algorithm>
#include <cstddef>
#include <glm/matrix.hpp>
#include <type_traits>
#include <utility>

namespace clothlab::sim {

namespace {

using glm::dmat3;
using glm::dvec3;
using model::Element;

/// For each two corners what the first feels of the second's motion.
template <class Law>
using CornerBlocks = std::array<std::array<dmat3, Element<Law>::corners>, Element<Law>::corners>;

/// The element's blocks in the rows of the corners from `from` on. A corner's row is linear in the edges that
/// start at it: it is the sum of a 3x3 block times each edge.
template <class Law>
CornerBlocks<Law> corner_blocks(const Element<Law>& element, const std::vector<glm::vec4>& position,
                                double dt, std::size_t from) {
  constexpr std::size_t corners = Element<Law>::corners;
  CornerBlocks<Law> blocks;
  for (std::size_t corner = from; corner < corners; ++corner) {
    const dvec3 here(position[element.vertices[corner]]);
    const auto row = elements::step_matrix(
        elements::element_hessian(
            law_at(element, corner),
            model::edges(element, corner,
                         [&](std::uint32_t other) { return here - dvec3(position[other]); })),
        dt);
    blocks[corner][corner] = dmat3(0.0);
    for (std::size_t edge = 0; edge + 1 < corners; ++edge) {
      dmat3 part;
      for (int axis = 0; axis < 3; ++axis) {
        dvec3 unit(0.0);
        unit[axis] = 1.0;
        part[axis] = elements::matrix_product(
            row, elements::make_edges<Law>([&](std::size_t k) { return k == edge ? unit : dvec3(0.0); }));
      }
      blocks[corner][corner] += part;
      blocks[corner][(corner + 1 + edge) % corners] = -part;
    }
  }
  return blocks;
}

/// What of a motion a contact with a collider does not prevent.
dmat3 free_part(const glm::vec4& constraint) {
  if (constraint.w < 0.0F) return dmat3(0.0);  // it sticks
  const dvec3 normal(constraint);
  return dmat3(1.0) - glm::outerProduct(normal, normal);
}

/// Adds `scale` times `part` to the block of two modes.
void add_scaled(PatchBlock& block, std::size_t row, std::size_t column, double scale, const dmat3& part) {
  for (int c = 0; c < 3; ++c) {
    double* const to = &block[(3 * column + static_cast<std::size_t>(c)) * patch_unknowns + 3 * row];
    for (int r = 0; r < 3; ++r) to[r] += scale * part[c][r];
  }
}

}  // namespace

CoarseMatrix::CoarseMatrix(model::Dissection dissection, std::vector<std::uint32_t> patch_of)
    : patch_of_(std::move(patch_of)), empty_(std::move(dissection)), matrix_(empty_) {}

void CoarseMatrix::set_parameters(const model::Model& model, const scene::Scene& scene) {
  dt_ = scene.solver.dt;
  air_drag_ = scene.air_drag;
  shares_ =
      shares_in_patches(model, patch_of_, static_cast<std::uint32_t>(empty_.dissection().places.size()));
  const auto pinned = [&](std::uint32_t vertex) { return model.pin_motion[vertex] != model::not_pinned; };
  model.elements.each([&]<class Law>(const model::Batch<Law>& batch) {
    Elements<Law>& kept = std::get<Elements<Law>>(elements_);
    kept.clear();
    for (const Element<Law>& element : batch)
      if (!std::all_of(element.vertices.begin(), element.vertices.end(), pinned)) kept.push_back(element);
  });
  bending_.clear();
  Elements<elements::Bending>& pairs = std::get<Elements<elements::Bending>>(elements_);
  if (scene.solver.method == scene::Method::bdf2) bending_ = pairs;
  add_bending(pairs);
  pairs.clear();
}

void CoarseMatrix::set_dt(double dt) {
  if (dt == dt_) return;
  dt_ = dt;
  add_bending(bending_);
}

void CoarseMatrix::add_bending(const Elements<elements::Bending>& pairs) {
  matrix_ = PatchMatrix(empty_.dissection());
  constraint_.clear();
  const std::vector<glm::vec4> anywhere(patch_of_.size(), glm::vec4(0.0F));
  for (const Element<elements::Bending>& pair : pairs) add_element(pair, anywhere);
  empty_ = matrix_;
}

void CoarseMatrix::make(const std::vector<glm::vec4>& position, const std::vector<glm::vec4>& constraint) {
  matrix_ = empty_;
  constraint_ = constraint;
  for (std::uint32_t i = 0; i < patch_of_.size(); ++i)
    if (position[i].w > 0.0F) add_unfiltered(i, i, dmat3((1.0 + dt_ * air_drag_) / position[i].w));
  std::apply(
      [&](const auto&... of_law) {
        const auto add_all = [&](const auto& all) {
          for (const auto& element : all) add_element(element, position);
        };
        (add_all(of_law), ...);
      },
      elements_);
}

void CoarseMatrix::add(std::uint32_t vertex, std::uint32_t other, const dmat3& part) {
  if (!touches(vertex) && !touches(other)) return add_unfiltered(vertex, other, part);
  const auto filter = [&](std::uint32_t of) { return touches(of) ? free_part(constraint_[of]) : dmat3(1.0); };
  add_unfiltered(vertex, other, filter(vertex) * part * filter(other));
}

void CoarseMatrix::add_pair(const PressingPair& pair) {
  std::vector<std::size_t> corners;  // that may move
  for (std::size_t k = 0; k < pair.vertices.size(); ++k)
    if (pair.vertices[k] < shares_.size() && shares_[pair.vertices[k]][0] != 0.0) corners.push_back(k);
  const auto apart = [&](std::size_t a, std::size_t b) {
    const std::uint32_t one = patch_of_[pair.vertices[a]], other = patch_of_[pair.vertices[b]];
    return !matrix_.couples(std::max(one, other), std::min(one, other));
  };
  bool dropped = false;
  for (const std::size_t a : corners)
    for (const std::size_t b : corners) dropped = dropped || apart(a, b);
  // |x + y|^2 is at most 2 |x|^2 + 2 |y|^2, and so on for up to four parts.
  const double scale = dropped ? static_cast<double>(corners.size()) : 1.0;
  for (const std::size_t a : corners)
    for (const std::size_t b : corners)
      if (!dropped || a == b)
        add(pair.vertices[a], pair.vertices[b],
            dt_ * dt_ * scale * pair.weights[a] * pair.weights[b] * pair.stiffness);
}

void CoarseMatrix::add_unfiltered(std::uint32_t vertex, std::uint32_t other, const dmat3& part) {
  const std::uint32_t row = patch_of_[vertex], column = patch_of_[other];
  if (row < column || !matrix_.couples(row, column)) return;  // the transposed is enough
  PatchBlock& block = matrix_.at(row, column);
  const Shares &mine = shares_[vertex], &others = shares_[other];
  for (std::size_t b = 0; b < patch_modes; ++b)
    for (std::size_t a = row == column ? b : 0; a < patch_modes; ++a)
      add_scaled(block, a, b, mine[a] * others[b], part);
}

template <class Law>
void CoarseMatrix::add_element(const Element<Law>& element, const std::vector<glm::vec4>& position) {
  constexpr std::size_t corners = Element<Law>::corners;
  const auto& vertices = element.vertices;
  const std::uint32_t patch = patch_of_[vertices[0]];
  const bool inside = std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t vertex) {
    return patch_of_[vertex] == patch && shares_[vertex][0] != 0.0 && !touches(vertex);
  });
  const CornerBlocks<Law> blocks = corner_blocks(element, position, dt_, inside ? 1 : 0);
  if (!inside) {
    for (std::size_t corner = 0; corner < corners; ++corner)
      for (std::size_t other = 0; other < corners; ++other)
        add(vertices[corner], vertices[other], blocks[corner][other]);
    return;
  }
  // Moved as a whole, the element feels nothing: what counts is how the other corners move against the first.
  PatchBlock& block = matrix_.at(patch, patch);
  const Shares& first = shares_[vertices[0]];
  for (std::size_t corner = 1; corner < corners; ++corner)
    for (std::size_t other = 1; other < corners; ++other)
      for (std::size_t b = 1; b < patch_modes; ++b)
        for (std::size_t a = b; a < patch_modes; ++a)
          add_scaled(block, a, b,
                     (shares_[vertices[corner]][a] - first[a]) * (shares_[vertices[other]][b] - first[b]),
                     blocks[corner][other]);
}

}  // namespace clothlab::sim
