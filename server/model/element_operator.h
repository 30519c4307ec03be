// Stiffness and damping of a cloth's elements about a shape, as linear operators that are never written out.
// In coordinates scaled by the square roots of the masses, y = M^(1/2) x, so that eigenvalues are those of
// M^-1 K and M^-1 C and both operators are symmetric. A pinned vertex has infinite mass: its y is 0.
#pragma once

#include <tuple>

#include "server/model/model.h"

namespace clothlab::model {

using Field = std::vector<dvec3>;  ///< one vector a vertex

class ElementOperator {
 public:
  /// About `shape` [vertex_count] [m]. What would make the stiffness indefinite is left out, as it can only
  /// lower frequencies: a compressed spring gives nothing across its direction, a stretched one k (1 - L/l).
  ElementOperator(const Model& model, const scene::Scene& scene, const Field& shape);

  std::size_t vertex_count() const { return scale_.size(); }
  /// No element has a vertex that is free: nothing can vibrate.
  bool empty() const;
  bool pinned(std::size_t vertex) const { return scale_[vertex] == 0.0; }
  bool any_free() const;

  /// stiff = M^-1/2 K M^-1/2 y [1/s^2], damped = M^-1/2 C M^-1/2 y [1/s], air drag included.
  void apply(const Field& y, Field& stiff, Field& damped) const;

  /// No eigenvalue of M^-1 K [1/s^2], or of M^-1 C [1/s], is larger. See dt_limit_bound.
  double stiffness_bound() const;
  double damping_bound() const;
  /// The smallest damping over stiffness of any element [s]: y.Cy >= this y.Ky for every y, air drag apart.
  double least_damping_time() const;
  double air_drag() const { return air_drag_; }  ///< [1/s]

 private:
  /// An element about the shape, as each of its corners sees it but the last: forces within it sum to zero.
  template <class Law>
  struct Linear {
    std::array<std::uint32_t, Element<Law>::corners> vertices;
    std::array<elements::Hessian<Law>, Element<Law>::corners - 1> hessian;
  };
  using Linears = std::tuple<std::vector<Linear<elements::Spring>>>;  // one a law

  template <class Law>
  void add(const Batch<Law>& batch, const Field& shape);
  template <class MatrixOf>
  double bound(MatrixOf matrix_of) const;

  Linears linears_;
  std::vector<double> scale_;  ///< [vertex_count] mass^(-1/2), 0 if pinned
  double air_drag_ = 0;
};

}  // namespace clothlab::model
