// The spring's law between two places, seen from the first one, for tests.
#pragma once

#include "shaders/elements/elements.h"

namespace clothlab::test {

using glm::dvec3;

inline dvec3 spring_force(const dvec3& x, const dvec3& y, const dvec3& v, const dvec3& w, double rest_length,
                          double stiffness, double damping) {
  return elements::element_force(elements::Spring{rest_length, stiffness, damping}, {x - y}, {v - w});
}
inline double spring_energy(const dvec3& x, const dvec3& y, double rest_length, double stiffness) {
  return elements::element_energy(elements::Spring{rest_length, stiffness, 0.0}, {x - y});
}
inline double spring_strain(const dvec3& x, const dvec3& y, double rest_length) {
  return elements::element_strain(elements::Spring{rest_length, 0.0, 0.0}, {x - y});
}
inline void spring_hessian(const dvec3& x, const dvec3& y, double rest_length, double stiffness, dvec3& n,
                           double& along, double& across) {
  const elements::SpringHessian h =
      elements::element_hessian(elements::Spring{rest_length, stiffness, 0.0}, {x - y});
  n = h.n;
  along = h.along;
  across = h.across;
}

}  // namespace clothlab::test
