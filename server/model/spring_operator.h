// Stiffness and damping of a cloth's springs about a shape, as linear operators that are never written out.
// In coordinates scaled by the square roots of the masses, y = M^(1/2) x, so that eigenvalues are those of
// M^-1 K and M^-1 C and both operators are symmetric. A pinned vertex has infinite mass: its y is 0.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

using Field = std::vector<dvec3>;  ///< one vector a vertex

class SpringOperator {
 public:
  /// About `shape` [vertex_count] [m]. A compressed spring gives nothing across its direction, as it can only
  /// lower frequencies; a stretched one gives k (1 - L/l) there.
  SpringOperator(const Model& model, const scene::Scene& scene, const Field& shape);

  std::size_t vertex_count() const { return scale_.size(); }
  /// No spring has a vertex that is free: nothing can vibrate.
  bool empty() const { return links_.empty(); }
  bool pinned(std::size_t vertex) const { return scale_[vertex] == 0.0; }
  bool any_free() const;

  /// stiff = M^-1/2 K M^-1/2 y [1/s^2], damped = M^-1/2 C M^-1/2 y [1/s], air drag included.
  void apply(const Field& y, Field& stiff, Field& damped) const;

  /// No eigenvalue of M^-1 K [1/s^2], or of M^-1 C [1/s], is larger. See dt_limit_bound.
  double stiffness_bound() const;
  double damping_bound() const;
  /// The smallest damping over stiffness of any spring [s]: y.Cy >= this y.Ky for every y, air drag apart.
  double least_damping_time() const;
  double air_drag() const { return air_drag_; }  ///< [1/s]

 private:
  struct Link {
    std::uint32_t a = 0, b = 0;
    dvec3 direction{0.0};  ///< unit, or 0 for a spring without length
    double along = 0;      ///< stiffness along the direction [N/m]
    double across = 0;     ///< and across it [N/m]
    double damping = 0;    ///< [N s/m]
  };
  double bound(double Link::*along, double Link::*across) const;

  std::vector<Link> links_;
  std::vector<double> scale_;  ///< [vertex_count] mass^(-1/2), 0 if pinned
  double air_drag_ = 0;
};

}  // namespace clothlab::model
