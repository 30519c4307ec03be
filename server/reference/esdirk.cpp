#include "server/reference/esdirk.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clothlab::reference {

namespace {

// ESDIRK3(2)4L[2]SA of Kennedy & Carpenter 2003 ("Additive Runge-Kutta schemes", appendix C: the implicit
// half of ARK3(2)4L[2]SA): of third order, L-stable, its last stage is the step's end. Its stages are of
// second order, which keeps that order where stiffness tends to a constraint: cloth that hardly stretches.
// Without an explicit first stage they would be of first order, and with them the whole (README.md has
// figures).
constexpr int stages = 4;
constexpr double gamma = 1767732205903.0 / 4055673282236.0;
constexpr double shares[stages][stages] = {
    {0.0, 0.0, 0.0, 0.0},
    {gamma, gamma, 0.0, 0.0},
    {2746238789719.0 / 10658868560708.0, -640167445237.0 / 6845629431997.0, gamma, 0.0},
    {1471266399579.0 / 7840856788654.0, -4482444167858.0 / 7529755066697.0,
     11266239266428.0 / 11593286722821.0, gamma}};
constexpr double times[stages] = {0.0, 2.0 * gamma, 0.6, 1.0};
/// Weights of the stages that give an end of second order.
constexpr double lower[stages] = {2756255671327.0 / 12835298489170.0, -10771552573575.0 / 22201958757719.0,
                                  9247589265047.0 / 10645013368117.0, 2193209047091.0 / 5459859503100.0};

/// A factor is kept, from stage to stage and from step to step, as long as each iteration leaves at most this
/// share of the change: an iteration costs a tenth of a new factor.
constexpr double good_contraction = 0.25;
constexpr int most_newton_iterations = 60;   // for one stage
constexpr double smallest_share = 1.0 / 64;  // of a step of Newton's method
constexpr double rounding = 100.0;           // times the precision: where the change no longer falls

double rms(const Vectors& vectors) {
  double sum = 0.0;
  for (const dvec3& v : vectors) sum += glm::dot(v, v);
  return std::sqrt(sum / static_cast<double>(vectors.size()));
}

}  // namespace

Vectors Esdirk::acceleration_at(const Vectors& x, const Vectors& v, double t, double h) {
  equation_.set(plus(x, -h, v), v, t, h);  // whose place at velocity v is x
  Vectors a = equation_.residual(v);
  for (std::size_t i = 0; i < a.size(); ++i) a[i] /= -h * world_.model.mass[i];
  return a;
}

Vectors Esdirk::change_for(const Vectors& residual) {
  ++work_.solves;
  return equation_.newton_step(residual);
}

bool Esdirk::factor(const Vectors& velocity) {
  ++work_.factors;
  factored_h_ = 0.0;
  if (!equation_.factor(velocity, stop_)) return false;
  factored_h_ = equation_.h();
  return true;
}

Esdirk::Outcome Esdirk::factor_failed() const {
  return stop_.stop_requested() ? Outcome::stopped : Outcome::unsolved;
}

// Newton's method, whose progress is judged by the length of the change that the same factor gives before and
// after a step (Deuflhard 2004, section 3.3: the natural monotonicity test), so that the unit of the
// equations does not matter. That next change is at once the next step with the old factor.
Esdirk::Outcome Esdirk::solve(Vectors& velocity) {
  const double enough = precision_ / equation_.h();
  // Two steps between the same times differ by rounding.
  bool fresh = std::abs(factored_h_ - equation_.h()) > 1e-3 * equation_.h();
  if (fresh && !factor(velocity)) return factor_failed();
  Vectors residual = equation_.residual(velocity), change = change_for(residual);
  double length = rms(change), share = 1.0;
  for (int n = 0; n < most_newton_iterations; ++n) {
    if (stop_.stop_requested()) return Outcome::stopped;
    Vectors next = plus(velocity, share, change);
    Vectors residual_next = equation_.residual(next), change_next = change_for(residual_next);
    const double length_next = rms(change_next), contraction = length_next / length;
    const bool nearer = contraction < 1.0 - 0.25 * share;  // false for what is not finite
    if (nearer) {
      velocity = std::move(next);
      residual = std::move(residual_next);
      change = std::move(change_next);
      length = length_next;
      if (share == 1.0 && length * contraction <= enough * (1.0 - contraction)) {
        velocity = plus(velocity, 1.0, change);
        return Outcome::done;
      }
      share = std::min(1.0, 2.0 * share);
      if (contraction <= good_contraction) {
        fresh = false;
        continue;
      }
    } else if (length <= rounding * enough) {
      return Outcome::done;
    } else if (fresh) {
      share *= 0.5;
      if (share < smallest_share) return Outcome::unsolved;
      continue;
    }
    if (!factor(velocity)) return factor_failed();
    change = change_for(residual);
    length = rms(change);
    fresh = true;
  }
  return Outcome::unsolved;
}

Esdirk::Outcome Esdirk::step(const StepStart& start, State& next) {
  const double dt = start.dt, h = gamma * dt;
  Vectors x = plus(start.state.position, 1.0, start.push), v = plus(start.state.velocity, 1.0, start.impulse);
  place_pins(world_, start.t, x, v);
  if (acceleration_.empty()) acceleration_ = acceleration_at(x, v, start.t, h);
  Vectors velocity[stages] = {v}, acceleration[stages] = {acceleration_};
  Vectors off = plus(Vectors(x.size(), dvec3(0.0)), dt * (shares[stages - 1][0] - lower[0]), v);
  ++work_.steps;
  for (int i = 1; i < stages; ++i) {
    Vectors from = x, from_velocity = v;
    for (int j = 0; j < i; ++j) {
      from = plus(from, dt * shares[i][j], velocity[j]);
      from_velocity = plus(from_velocity, dt * shares[i][j], acceleration[j]);
    }
    equation_.set(from, from_velocity, start.t + times[i] * dt, h);
    velocity[i] = plus(from_velocity, h, acceleration[i - 1]);
    if (const Outcome outcome = solve(velocity[i]); outcome != Outcome::done) return outcome;
    next.position = equation_.places(velocity[i]);
    acceleration[i] = plus(Vectors(x.size(), dvec3(0.0)), 1.0 / h, plus(velocity[i], -1.0, from_velocity));
    for (std::size_t k = 0; k < x.size(); ++k)
      if (world_.pinned(k)) acceleration[i][k] = dvec3(0.0);
    off = plus(off, dt * (shares[stages - 1][i] - lower[i]), velocity[i]);
  }
  next.velocity = velocity[stages - 1];
  acceleration_ = acceleration[stages - 1];
  for (std::size_t k = 0; k < x.size(); ++k)
    if (world_.pinned(k)) off[k] = dvec3(0.0);
  error_ = rms(off);
  return Outcome::done;
}

}  // namespace clothlab::reference
