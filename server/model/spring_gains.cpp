#include "server/model/spring_gains.h"

#include <cmath>

namespace clothlab::model {

SpringGains spring_gains(const scene::Solver& solver, double stiffness, double damping, double inverse_mass) {
  const double k = stiffness * solver.dt * solver.dt, c = damping * solver.dt;
  const double coupling = inverse_mass * (k + c);
  if (solver.method == scene::Method::xpbd) {
    const double share = 1.0 / (1.0 + coupling);
    return {share * k, share * c, share};
  }
  if (!(coupling > 0.0)) return {k, c, 0.0};
  const double share = -std::expm1(-std::log1p(coupling) / solver.iterations) / coupling;
  return {share * k, share * c, 0.0};
}

}  // namespace clothlab::model
