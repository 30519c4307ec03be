// What colouring gains: iterations of XPBD on one step of the seed's cloth until a thousandth of the step's
// residual is left, by Gauss-Seidel in the order of the colours and by Jacobi, where all springs use the same
// displacements. Jacobi applies the full change, the largest share that converges, or a share that always
// converges. In double precision. Prints a JSON document.
//
// Prediction. Jacobi adds D^-1 (b - A p), A = J M^-1 J^T + 1 / (k dt^2 + c dt) and D its diagonal: it
// converges if the largest eigenvalue of D^-1 A is below 2 (here by power iteration at the start), which is
// at most the largest row sum. A share of 1 / (springs at the end with more of them) makes every row sum at
// most 1, since a row has at most the springs of its two ends, each with at most half of the diagonal: it
// always converges.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <vector>

#include "server/model/constraint_gains.h"
#include "server/reference/contacts.h"
#include "server/reference/reference.h"
#include "shaders/elements/elements.h"
#include "tests/bench/seed.h"

using namespace clothlab;
using scene::Method;
using Vectors = std::vector<glm::dvec3>;

namespace {

constexpr int most_iterations = 20000;

struct Step {
  const reference::World& world;
  Vectors x, free;
  std::vector<double> w;
  std::vector<double> springs_at;  ///< of each vertex

  Step(const reference::World& in, const reference::State& state) : world(in), x(state.position) {
    const double dt = world.scene.solver.dt;
    springs_at.assign(x.size(), 0.0);
    for (std::uint32_t i = 0; i < x.size(); ++i) {
      w.push_back(reference::inverse_mass(world, i));
      free.push_back(w[i] > 0.0 ? dt * state.velocity[i] + dt * dt * world.scene.gravity : glm::dvec3(0.0));
    }
    for (const model::Spring& spring : world.model.springs()) {
      springs_at[spring.vertices[0]] += 1.0;
      springs_at[spring.vertices[1]] += 1.0;
    }
  }

  double weight(const model::Spring& spring) const { return w[spring.vertices[0]] + w[spring.vertices[1]]; }

  elements::ConstraintGains gains(const model::Spring& spring) const {
    return model::constraint_gains(world.scene.solver, spring.law.stiffness, spring.law.damping,
                                   weight(spring));
  }

  glm::dvec3 change(const model::Spring& spring, const Vectors& d, const glm::dvec3& pushed) const {
    const elements::ConstraintGains gain = gains(spring);
    const glm::dvec3 moved = d[spring.vertices[0]] - d[spring.vertices[1]];
    return elements::element_projection(
               spring.law, gain, {(x[spring.vertices[0]] - x[spring.vertices[1]]) + moved}, {moved}, {pushed})
        .d[0];
  }

  void push(const model::Spring& spring, const glm::dvec3& by, Vectors& d) const {
    d[spring.vertices[0]] += w[spring.vertices[0]] * by;
    d[spring.vertices[1]] -= w[spring.vertices[1]] * by;
  }

  /// Largest momentum that implicit Euler's equation leaves unsolved at a free vertex [kg m].
  double residual(const Vectors& d) const {
    const double dt = world.scene.solver.dt;
    Vectors end = x, velocity = d;
    for (std::size_t i = 0; i < d.size(); ++i) {
      end[i] += d[i];
      velocity[i] /= dt;
    }
    const Vectors force = reference::element_forces(world, end, velocity);
    double most = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i)
      if (w[i] > 0.0) most = std::max(most, glm::length((free[i] - d[i]) / w[i] + dt * dt * force[i]));
    return most;
  }
};

/// In the order of the colours; or all at once from the same displacements: with the full change, as much as
/// the eigenvalue allows, or divided by the number of springs at the end with more.
enum class Order { colours, at_once, relaxed, shared };

/// Iterations until the residual is a thousandth of the first; `most_iterations` if never; a negative number
/// if it grew a thousandfold.
int iterations_needed(const Step& step, Order order, double eigenvalue = 0.0) {
  const model::Batch<elements::Spring>& springs = step.world.model.springs();
  Vectors d = step.free, pushed(springs.size(), glm::dvec3(0.0)), by(pushed);
  const double start = step.residual(d);
  for (int n = 1; n < most_iterations; ++n) {
    for (const std::uint32_t s : step.world.element_colours[0].order) {
      if (step.weight(springs[s]) == 0.0) continue;
      by[s] = step.change(springs[s], d, pushed[s]);
      if (order == Order::shared)
        by[s] /= std::max(step.springs_at[springs[s].vertices[0]], step.springs_at[springs[s].vertices[1]]);
      if (order == Order::relaxed) by[s] *= 1.9 / std::max(eigenvalue, 1.9);
      pushed[s] += by[s];
      if (order == Order::colours) step.push(springs[s], by[s], d);
    }
    if (order != Order::colours)
      for (std::size_t s = 0; s < springs.size(); ++s) step.push(springs[s], by[s], d);
    const double left = step.residual(d);
    if (left < 1e-3 * start) return n;
    if (!(left < 1e3 * start)) return -n;
  }
  return most_iterations;
}

/// Largest eigenvalue of D^-1 A, a lower bound, and its largest row sum.
struct Spectrum {
  double eigenvalue = 0, row_sum = 0;
};
Spectrum spectrum(const Step& step) {
  const model::Batch<elements::Spring>& springs = step.world.model.springs();
  std::vector<glm::dvec3> n;
  std::vector<double> diagonal, p(springs.size());
  for (const model::Spring& spring : springs) {
    n.push_back(glm::normalize(step.x[spring.vertices[0]] - step.x[spring.vertices[1]]));
    const elements::ConstraintGains gains = step.gains(spring);
    diagonal.push_back(1.0 / (gains.stretch + gains.damping));  // W + 1 / (k dt^2 + c dt)
  }
  Spectrum found;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    double sum = diagonal[s];
    for (const std::uint32_t end : springs[s].vertices)
      for (std::uint32_t slot = springs.at_vertex.offsets[end]; slot < springs.at_vertex.offsets[end + 1];
           ++slot) {
        const std::uint32_t other = springs.at_vertex.items[slot] / 2;
        if (other != s) sum += step.w[end] * std::abs(glm::dot(n[s], n[other]));
      }
    found.row_sum = std::max(found.row_sum, sum / diagonal[s]);
    p[s] = std::sin(static_cast<double>(7 * s + 1));
  }
  for (int turn = 0; turn < 300; ++turn) {
    Vectors moved(step.x.size(), glm::dvec3(0.0));
    for (std::size_t s = 0; s < springs.size(); ++s) step.push(springs[s], p[s] * n[s], moved);
    double norm = 0.0, product = 0.0;
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const double compliance = diagonal[s] - step.weight(springs[s]);
      const double next = (glm::dot(n[s], moved[springs[s].vertices[0]] - moved[springs[s].vertices[1]]) +
                           compliance * p[s]) /
                          diagonal[s];
      product += p[s] * next * diagonal[s];
      norm += p[s] * p[s] * diagonal[s];
      p[s] = next;
    }
    found.eigenvalue = product / norm;
    const double scale = 1.0 / std::sqrt(norm);
    for (double& one : p) one *= scale;
  }
  return found;
}

}  // namespace

int main() {
  scene::Scene scene = bench::seed_of(25);
  scene.colliders.clear();
  for (scene::Pin& pin : scene.cloths[0].pins) pin.motion = {};
  scene.solver = {.method = Method::symplectic_euler, .dt = 5e-4};
  const reference::World start_world = *reference::make_world(scene, 0.0);
  reference::State start = reference::at_rest(start_world);
  for (int n = 0; n < 400; ++n) reference::step(start_world, start);
  std::printf(
      "{\n \"what\": \"iterations of XPBD until 1/1000 of one step's residual is left, on the seed's cloth "
      "at 0.2 s\",\n");
  std::printf(" \"most\": %d,\n \"rows\": [\n", most_iterations);
  const double steps[] = {5e-4, 1e-3, 2e-3, 5e-3, 1.0 / 60.0};
  for (const double dt : steps) {
    scene.solver = {.method = Method::xpbd, .dt = dt};
    const reference::World world = *reference::make_world(scene, 0.0);
    const Step step(world, start);
    const Spectrum radius = spectrum(step);
    std::printf(
        "  {\"dt_s\": %.6f, \"row_sum\": %.3f, \"largest_eigenvalue\": %.3f, \"jacobi_should\": \"%s\", "
        "\"gauss_seidel\": %d, \"jacobi\": %d, \"jacobi_relaxed\": %d, \"jacobi_shared\": %d}%s\n",
        dt, radius.row_sum, radius.eigenvalue, radius.eigenvalue > 2.0 ? "diverge" : "converge",
        iterations_needed(step, Order::colours), iterations_needed(step, Order::at_once),
        iterations_needed(step, Order::relaxed, radius.eigenvalue), iterations_needed(step, Order::shared),
        dt == steps[4] ? "" : ",");
    std::fflush(stdout);
  }
  std::printf(" ],\n \"note\": \"-n: grew a thousandfold by iteration n\"\n}\n");
}
