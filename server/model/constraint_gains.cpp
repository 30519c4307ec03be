#include "server/model/constraint_gains.h"

#include <algorithm>
#include <cmath>

namespace clothlab::model {

double mobility(const scene::Scene& scene) {
  return 1.0 / (1.0 + scene.solver.dt * scene.air_drag);
}

elements::ConstraintGains constraint_gains(const scene::Solver& solver, double stiffness, double damping,
                                           double inverse_mass) {
  const double k = stiffness * solver.dt * solver.dt, c = damping * solver.dt;
  const double coupling = inverse_mass * (k + c);
  if (solver.method == scene::Method::xpbd) {
    const double share = 1.0 / (1.0 + coupling);
    return {share * k, share * c, share, inverse_mass * k};
  }
  if (!(coupling > 0.0)) return {k, c, 0.0, 0.0};
  const double share = -std::expm1(-std::log1p(coupling) / solver.iterations) / coupling;
  return {share * k, share * c, 0.0, 0.0};
}

namespace {

double median_mass(const Model& model, const ClothRange& cloth) {
  const auto first = model.mass.begin() + cloth.first_vertex;
  std::vector<double> mass(first, first + cloth.vertex_count);
  const auto middle = mass.begin() + cloth.vertex_count / 2;
  std::nth_element(mass.begin(), middle, mass.end());
  return *middle;
}

}  // namespace

std::vector<PbdStiffness> pbd_stiffness(const Model& model, const scene::Scene& scene) {
  std::vector<PbdStiffness> result(scene.cloths.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const scene::Springs& material = scene.cloths[i].springs();
    const double inverse_mass = 2.0 * mobility(scene) / median_mass(model, model.cloths[i]);
    for (const SpringKind kind : {SpringKind::structural, SpringKind::shear, SpringKind::bend}) {
      const double k = stiffness(material, kind);
      if (k > 0.0)
        result[i][static_cast<std::size_t>(kind)] =
            inverse_mass * constraint_gains(scene.solver, k, material.damping, inverse_mass).stretch;
    }
  }
  return result;
}

}  // namespace clothlab::model
