// The equation of one stage of an implicit Runge-Kutta method, and its matrix.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "server/reference/reference.h"
#include "server/reference/vectors.h"

namespace clothlab::reference {

/// r(V) = M (V - v) - h f(x + h V, V, t) = 0 at the free vertices, for the velocity V of a stage [m/s]: f are
/// all forces, those of elements, gravity, air drag and the wind, at the stage's places, velocities and time.
///
/// Its matrix is M + h C + h^2 K with the true second derivatives, stress of damping included. It leaves out
/// what is not symmetric: that a damped element's direction of stretching turns (a share of the turn in a
/// damping time), and how the wind follows velocity and slope but for its braking. The residual is exact, so
/// that only the number of iterations depends on the matrix.
class StageEquation {
 public:
  explicit StageEquation(const World& world);
  ~StageEquation();

  /// Sets the stage: `x` [m], `v` [m/s] as above at free vertices; the pins are placed at time t [s].
  void set(Vectors x, Vectors v, double t, double h);
  double h() const { return h_; }

  /// The places at velocity V; pinned vertices are where their motions are. Sets V of pinned vertices.
  Vectors places(Vectors& velocity) const;
  /// r, 0 at pinned vertices [kg m/s].
  Vectors residual(const Vectors& velocity) const;

  /// Factors the matrix at V. Where it is not positive definite, the parts that make it so are left out.
  /// False: stopped, or a matrix that cannot be factored.
  bool factor(const Vectors& velocity, const std::stop_token& stop);
  /// -(the last factor's matrix)^-1 r, 0 at pinned vertices [m/s].
  Vectors newton_step(const Vectors& residual);

 private:
  enum class Matrix { exact, definite };
  void assemble(const Vectors& velocity, Matrix kind);
  template <class Law>
  void add_element(const model::Element<Law>& element, const Vectors& x, const Vectors& v, Matrix kind,
                   std::size_t& next);

  const World& world_;
  std::vector<std::int32_t> number_;  ///< [vertex] its number among the free ones; -1: pinned
  struct Assembly;                    ///< the matrix, and where elements add to it
  std::unique_ptr<Assembly> assembly_;
  Vectors x_, v_, pin_place_, pin_velocity_;
  double t_ = 0, h_ = 0;
};

}  // namespace clothlab::reference
