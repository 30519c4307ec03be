#include "server/model/element_operator.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "server/model/small_eigen.h"

namespace clothlab::model {

namespace {

/// Calls visit(linear) for each linearised element of every law.
template <class Linears, class Visit>
void each_linear(const Linears& linears, Visit visit) {
  std::apply(
      [&](const auto&... of_law) {
        const auto all = [&](const auto& list) {
          for (const auto& linear : list) visit(linear);
        };
        (all(of_law), ...);
      },
      linears);
}

/// An element's edges as seen from corner `of`: its value in `vector` less that of each other corner.
template <class Law, std::size_t corners>
elements::Edges<Law> edges_of(const std::array<dvec3, corners>& vector, std::size_t of) {
  return elements::make_edges<Law>(
      [&](std::size_t other) { return vector[of] - vector[(of + 1 + other) % corners]; });
}

/// The element's matrix times `vector`, which has one value for each corner.
template <class Law, std::size_t corners, class Hessians, class MatrixOf>
std::array<dvec3, corners> product(const Hessians& hessian, const std::array<dvec3, corners>& vector,
                                   MatrixOf matrix_of) {
  std::array<dvec3, corners> result;
  dvec3& last = result[corners - 1] = dvec3(0.0);
  for (std::size_t c = 0; c + 1 < corners; ++c) {
    result[c] = elements::matrix_product(matrix_of(hessian[c]), edges_of<Law>(vector, c));
    last -= result[c];
  }
  return result;
}

constexpr auto stiffness_of = [](const auto& hessian) { return elements::stiffness_matrix(hessian); };
constexpr auto damping_of = [](const auto& hessian) { return elements::damping_matrix(hessian); };

}  // namespace

ElementOperator::ElementOperator(const Model& model, const scene::Scene& scene, const Field& shape)
    : air_drag_(scene.air_drag) {
  scale_.reserve(model.mass.size());
  for (std::size_t i = 0; i < model.mass.size(); ++i)
    scale_.push_back(model.pin_motion[i] == not_pinned ? 1.0 / std::sqrt(model.mass[i]) : 0.0);
  model.elements.each([&](const auto& batch) { add(batch, shape); });
}

template <class Law>
void ElementOperator::add(const Batch<Law>& batch, const Field& shape) {
  auto& linears = std::get<LinearList<Law>>(linears_);
  linears.reserve(batch.size());
  for (const Element<Law>& element : batch) {
    const auto held = [&](std::uint32_t vertex) { return pinned(vertex); };
    if (std::all_of(element.vertices.begin(), element.vertices.end(), held)) continue;
    Linear<Law> linear{element.vertices, {}};
    for (std::size_t c = 0; c < linear.hessian.size(); ++c)
      linear.hessian[c] = elements::without_rounding(elements::element_definite(
          elements::element_hessian(law_at(element, c), edges(element, c, shape))));
    linears.push_back(linear);
  }
}

bool ElementOperator::empty() const {
  bool none = true;
  each_linear(linears_, [&](const auto&) { none = false; });
  return none;
}

bool ElementOperator::any_free() const {
  return std::any_of(scale_.begin(), scale_.end(), [](double scale) { return scale > 0.0; });
}

void ElementOperator::apply(const Field& y, Field& stiff, Field& damped) const {
  for (std::size_t i = 0; i < y.size(); ++i) {
    stiff[i] = dvec3(0.0);
    damped[i] = air_drag_ * y[i];
  }
  each_linear(linears_, [&]<class Law>(const Linear<Law>& linear) {
    std::array<dvec3, Element<Law>::corners> vector;
    for (std::size_t c = 0; c < vector.size(); ++c)
      vector[c] = scale_[linear.vertices[c]] * y[linear.vertices[c]];
    const auto force = product<Law>(linear.hessian, vector, stiffness_of);
    const auto drag = product<Law>(linear.hessian, vector, damping_of);
    for (std::size_t c = 0; c < vector.size(); ++c) {
      stiff[linear.vertices[c]] += scale_[linear.vertices[c]] * force[c];
      damped[linear.vertices[c]] += scale_[linear.vertices[c]] * drag[c];
    }
  });
}

// An element adds |sum of a_c|^2 to y.Ky, with a_c = L_c y_c / sqrt(m_c) for each of its f free corners c and
// L_c^T L_c = K_cc, the corner's block of its matrix. For any masses |sum of f vectors|^2 <= f times the sum
// of their squares (Cauchy & Schwarz). So K is bounded by a matrix with one 3x3 block for each vertex: the
// sum of f K_cc / m_c over its elements.
template <class MatrixOf>
double ElementOperator::bound(MatrixOf matrix_of) const {
  std::vector<glm::dmat3> block(scale_.size(), glm::dmat3(0.0));
  each_linear(linears_, [&]<class Law>(const Linear<Law>& linear) {
    constexpr std::size_t corners = Element<Law>::corners;
    const auto free = std::count_if(linear.vertices.begin(), linear.vertices.end(),
                                    [&](std::uint32_t vertex) { return !pinned(vertex); });
    auto bounds = linear.hessian;
    for (auto& hessian : bounds) hessian = elements::element_bound(hessian);
    const auto add = [&](std::size_t c, const glm::dmat3& own) {  // own: the corner's block K_cc
      const double scale = scale_[linear.vertices[c]];
      block[linear.vertices[c]] += static_cast<double>(free) * scale * scale * own;
    };
    for (std::size_t c = 0; c + 1 < corners; ++c) {
      dvec3 diagonal(0.0), below(0.0);  // below: the elements 21, 31, 32
      elements::add_block(matrix_of(bounds[c]), diagonal, below);
      add(c, {diagonal[0], below[0], below[1], below[0], diagonal[1], below[2], below[1], below[2],
              diagonal[2]});
    }
    glm::dmat3 last(0.0);  // one column for each axis
    for (int axis = 0; axis < 3; ++axis) {
      std::array<dvec3, corners> vector{};
      vector[corners - 1][axis] = 1.0;
      last[axis] = product<Law>(bounds, vector, matrix_of)[corners - 1];
    }
    add(corners - 1, last);
  });
  double largest = 0.0;
  for (const glm::dmat3& matrix : block) largest = std::max(largest, largest_eigenpair(matrix).value);
  return largest;
}

double ElementOperator::stiffness_bound() const {
  return bound(stiffness_of);
}

double ElementOperator::damping_bound() const {
  return bound(damping_of) + air_drag_;
}

double ElementOperator::least_damping_time() const {
  double least = std::numeric_limits<double>::infinity();
  each_linear(linears_, [&](const auto& linear) {
    for (const auto& hessian : linear.hessian) least = std::min(least, elements::least_damping_time(hessian));
  });
  return least;
}

}  // namespace clothlab::model
