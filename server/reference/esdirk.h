// Steps of a singly diagonally implicit Runge-Kutta method with an explicit first stage, L-stable and of
// third order, with an estimate of their error: for cloth so stiff that RK4 would need hundreds of thousands
// of steps a second.
#pragma once

#include <stop_token>

#include "server/reference/methods.h"
#include "server/reference/pace.h"
#include "server/reference/stage_equation.h"

namespace clothlab::reference {

class Esdirk {
 public:
  /// The stages' equations are solved to `precision` [m]: RMS over the vertices. `world` must outlive this.
  Esdirk(const World& world, double precision, const std::stop_token& stop)
      : equation_(world), world_(world), precision_(precision), stop_(stop) {}

  enum class Outcome { done, unsolved, stopped };
  /// A step from `start`, in which `next` becomes the state at its end, without contacts.
  Outcome step(const StepStart& start, State& next);

  /// Of the last step: RMS over the vertices of the distance to the end of a step of second order [m]. With a
  /// step of half the length it is an eighth.
  double error() const { return error_; }

  /// [vertex_count] at the last step's end, by its method alone [m/s^2]: the next step's first stage. Whoever
  /// goes back to an earlier state gives its acceleration back. Empty: a step starts anew.
  const Vectors& acceleration() const { return acceleration_; }
  void set_acceleration(const Vectors& of) { acceleration_ = of; }

  const EsdirkWork& work() const { return work_; }
  void set_work(const EsdirkWork& work) { work_ = work; }

 private:
  /// Solves the stage's equation from `velocity` on.
  Outcome solve(Vectors& velocity);
  Vectors acceleration_at(const Vectors& x, const Vectors& v, double t, double h);
  Vectors change_for(const Vectors& residual);
  bool factor(const Vectors& velocity);
  Outcome factor_failed() const;

  StageEquation equation_;
  const World& world_;
  double precision_;
  std::stop_token stop_;
  double error_ = 0, factored_h_ = 0;
  EsdirkWork work_;
  Vectors acceleration_;
};

}  // namespace clothlab::reference
