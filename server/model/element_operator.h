// Stiffness K and damping C of a cloth's elements, linearised about a shape, as operators without a stored
// matrix. Coordinates are scaled by the square roots of the masses, y = M^(1/2) x: then both operators are
// symmetric, and their eigenvalues are those of M^-1 K and M^-1 C. A pinned vertex has infinite mass: its
// displacement is 0.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

using Field = std::vector<dvec3>;  ///< [vertex_count] one vector for each vertex

class ElementOperator {
 public:
  /// Linearises about `shape` [vertex_count] [m]. Leaves out the part that would make K indefinite, as that
  /// part can only lower frequencies: across its direction, a compressed spring has no stiffness, a stretched
  /// one k (1 - L/l), with L its rest length and l its length.
  ElementOperator(const Model& model, const scene::Scene& scene, const Field& shape);

  std::size_t vertex_count() const { return scale_.size(); }
  /// True if no element has a free vertex: nothing can vibrate.
  bool empty() const;
  bool pinned(std::size_t vertex) const { return scale_[vertex] == 0.0; }
  bool any_free() const;

  /// stiff = M^-1/2 K M^-1/2 y [1/s^2], damped = M^-1/2 C M^-1/2 y [1/s], air drag included.
  void apply(const Field& y, Field& stiff, Field& damped) const;

  /// Upper bounds of the eigenvalues of M^-1 K [1/s^2] and of M^-1 C [1/s]. See dt_limit_bound.
  double stiffness_bound() const;
  double damping_bound() const;
  /// The smallest ratio t of damping to stiffness of any element [s]: y.Cy >= t y.Ky for every y, where C is
  /// without air drag. Infinity without elements.
  double least_damping_time() const;
  double air_drag() const { return air_drag_; }  ///< [1/s]

 private:
  /// A linearised element: its Hessian as seen from each corner but the last, whose force follows from the
  /// others, as the forces within an element sum to zero.
  template <class Law>
  struct Linear {
    std::array<std::uint32_t, Element<Law>::corners> vertices;
    std::array<elements::Hessian<Law>, Element<Law>::corners - 1> hessian;
  };
  template <class Law>
  using LinearList = std::vector<Linear<Law>>;

  template <class Law>
  void add(const Batch<Law>& batch, const Field& shape);
  template <class MatrixOf>
  double bound(MatrixOf matrix_of) const;

  elements::PerLaw<LinearList> linears_;
  std::vector<double> scale_;  ///< [vertex_count] mass^(-1/2), 0 if pinned
  double air_drag_ = 0;
};

}  // namespace clothlab::model
