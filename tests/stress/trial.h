// One run of a stress scene on the GPU, and the verdict on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

#include "server/model/stability.h"
#include "server/reference/rest_shape.h"
#include "server/sim/colliders.h"
#include "server/sim/guarded_run.h"
#include "tests/stress/cases.h"

namespace clothlab::stress {

using glm::dvec3;

inline constexpr double still = 5e-3;  ///< RMS speed of a cloth at rest [m/s]: 0.3 mm in a frame
/// RMS distance from the rest shape [m]: half a percent of the cloth's size
inline constexpr double near = 5e-3;
inline constexpr double most_steps = 4e4;   ///< of a run; a method that needs more is stopped after these
inline constexpr double fewest_steps = 12;  ///< of a run, so that a blow-up has time to show

enum class Ending {
  holds,
  not_finite,
  blows_up,
  restless,
  elsewhere,
  passes_through,
  falls_wrong,
  overstretched
};

struct Verdict {
  Ending ending = Ending::holds;
  std::string text;  ///< how it failed, with a number
  bool at_rest_shape = false;
  bool cut_short = false;  ///< too many steps: only known not to have blown up so far
  bool alarm = false;      ///< the server's own watch reported a blow-up
};

inline std::string format(const char* form, double value) {
  char text[160];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

/// The hanging cloth at rest, by the reference. It starts upright above the edge that holds it, a little
/// bent, so that the solver finds a minimum and not the saddle of the plane.
inline const std::vector<dvec3>& rest_shape(scene::Scene scene) {
  static std::map<std::string, std::vector<dvec3>> known;
  scene.cloths[0].transform.rotate = {90, 0, 0};
  scene.cloths[0].start = {};
  const scene::Springs& k = scene.cloths[0].springs();
  char key[200];
  std::snprintf(key, sizeof key, "%g %g %g %g %g %g", k.structural, k.shear, k.bend,
                scene.cloths[0].mass.value,
                scene.cloths[0].weights.empty() ? 0.0 : scene.cloths[0].weights[0].mass,
                scene.cloths[0].transform.translate.x);
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  reference::World world = *reference::make_world(scene, 0.0);
  for (std::size_t i = 0; i < world.model.rest_position.size(); ++i)
    if (!world.pinned(i)) world.model.rest_position[i].z += 1e-3 * std::sin(3.0 * static_cast<double>(i));
  const auto shape = reference::rest_shape(world);
  if (!shape) std::fprintf(stderr, "rest shape of %s: %s\n", key, shape.error().text().c_str());
  return known[key] = shape ? shape->position : std::vector<dvec3>();
}

/// RMS distance [m] from the shape or from its mirror image in the plane of the pins, whichever is less.
inline double distance_to(const std::vector<dvec3>& shape, const sim::State& state) {
  double straight = 0.0, mirrored = 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const dvec3 x = state.position[i], image = shape[i] * dvec3(1, 1, -1);
    straight += glm::dot(x - shape[i], x - shape[i]);
    mirrored += glm::dot(x - image, x - image);
  }
  return std::sqrt(std::min(straight, mirrored) / static_cast<double>(shape.size()));
}

class Trial {
 public:
  /// `compared`: a pulled cloth is also compared with a run of RK4, which takes a second.
  Trial(const Case& test, const scene::Scene& scene, bool compared = true)
      : test_(test), scene_(scene), compared_(compared) {}

  Verdict run() {
    auto made = sim::Simulation::create(scene_);
    if (!made) return {Ending::not_finite, made.error().text()};
    sim::Simulation& simulation = **made;
    const double wanted = whole_steps();
    const auto steps = static_cast<std::uint32_t>(std::min(wanted, most_steps));
    const std::uint32_t stride = std::max(1u, steps / 90);
    sim::GuardedRun guard(simulation);
    guard.start(model::dt_limit(simulation.model(), scene_));
    const double allowed = allowed_energy(simulation, guard.state());
    Verdict verdict;
    verdict.cut_short = wanted > most_steps;
    for (std::uint32_t done = 0; done < steps;) {
      const std::uint32_t now = std::min(stride, steps - done);
      simulation.step(now);
      done += now;
      verdict.alarm = guard.judge_now() == sim::GuardedRun::Verdict::blown_up || verdict.alarm;
      const sim::Diagnostics& state = guard.state();
      const double t = state.time;
      if (!state.finite || !std::isfinite(state.kinetic))
        return fail(verdict, Ending::not_finite, format("not finite after %.3g s", t));
      if (state.kinetic > allowed) return fail(verdict, Ending::blows_up, format("blows up after %.3g s", t));
      last_ = state;
      if (test_.check == Check::struck) judge_sphere(simulation, verdict);
      if (verdict.ending != Ending::holds) return verdict;
    }
    if (!verdict.cut_short) judge(simulation, verdict);
    if (verdict.alarm && verdict.ending == Ending::restless)
      verdict.text += ", and the watch calls it diverged";
    return verdict;
  }

 private:
  static Verdict fail(Verdict& verdict, Ending ending, std::string text) {
    verdict.ending = ending;
    verdict.text = std::move(text);
    return verdict;
  }

  /// Energy [J] above which a run is unbounded: ten times all that the scene can put into motion, that is the
  /// energy of its springs, of a fall by twice its size, and of a throw by its moving parts.
  double allowed_energy(const sim::Simulation& simulation, const sim::Diagnostics& first) {
    const model::Model& model = simulation.model();
    double mass = 0.0;
    for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
      if (model.pin_motion[i] == model::not_pinned) mass += model.mass[i];
    mass_ = mass;
    const sim::Allowance speeds = sim::allowance(scene_, model, model::no_limit);
    const double speed = speeds.pin_speed + speeds.collider_speed;
    return 10 * (first.elastic + 2 * mass * glm::length(scene_.gravity) + 2 * mass * speed * speed);
  }

  void judge(sim::Simulation& simulation, Verdict& verdict) {
    const sim::State state = simulation.read_state();
    switch (test_.check) {
      case Check::settles:
      case Check::untangles:
        return judge_rest(state, verdict);
      case Check::bounded:
      case Check::struck:
        return;
      case Check::falls:
        return judge_fall(simulation.model(), state, verdict);
      case Check::pulled:
        return judge_stretch(state, verdict);
    }
  }

  void judge_rest(const sim::State& state, Verdict& verdict) {
    const double speed = std::sqrt(2 * last_.kinetic / mass_), off = distance_to(rest_shape(scene_), state);
    verdict.at_rest_shape = off < near;
    if (!(speed < still))
      fail(verdict, Ending::restless,
           format("not at rest after %.0f s: ", last_.time) + format("RMS %.2g m/s", speed));
    else if (!verdict.at_rest_shape && test_.check == Check::settles)
      fail(verdict, Ending::elsewhere, format("settles elsewhere: RMS %.3g mm away", 1e3 * off));
  }

  void judge_fall(const model::Model& model, const sim::State& state, Verdict& verdict) {
    dvec3 moved(0.0);
    for (std::size_t i = 0; i < state.position.size(); ++i)
      moved +=
          (dvec3(state.position[i]) - model.start_position[i]) / static_cast<double>(state.position.size());
    const dvec3 fall = 0.5 * last_.time * last_.time * scene_.gravity;
    // A method of order 1 is off by g t dt / 2; the rest allows for 32-bit rounding.
    const double first_order = 0.5 * glm::length(scene_.gravity) * last_.time * scene_.solver.dt;
    const double off = glm::distance(moved, fall);
    if (!(off < 1.01 * first_order + 1e-3))
      fail(verdict, Ending::falls_wrong, format("falls %.3g mm off", 1e3 * off));
    else if (!(last_.max_strain < 1e-3))
      fail(verdict, Ending::falls_wrong, format("does not stay flat: strain %.2g", last_.max_strain));
  }

  /// Called at every look. It checks only once if the cloth is taken along, when the sphere has come as far
  /// as it should: later any cloth slides off.
  void judge_sphere(sim::Simulation& simulation, Verdict& verdict) {
    const sim::State state = simulation.read_state();
    const scene::Collider collider = simulation.colliders_now()[0];
    const auto& sphere = std::get<scene::Sphere>(collider.shape);
    double deepest = 0.0;
    for (const glm::vec3& x : state.position)
      deepest = std::max(deepest, sphere.radius - glm::distance(dvec3(x), sphere.center));
    const glm::vec3 middle = state.position[state.position.size() / 2];
    const bool arrived = !arrived_ && last_.time > test_.seconds - 1e-9;
    arrived_ = arrived_ || arrived;
    if (arrived && !(middle.z > sphere.center.z))
      fail(verdict, Ending::passes_through,
           format("the sphere passes: its middle is %.3g m ahead of the cloth's",
                  sphere.center.z - static_cast<double>(middle.z)));
    else if (!(deepest < 1e-4))
      fail(verdict, Ending::passes_through, format("a vertex is %.2g mm inside the sphere", 1e3 * deepest));
  }

  double whole_steps() const {
    return std::max(fewest_steps, std::ceil(test_.seconds / scene_.solver.dt - 1e-9));
  }

  /// Strain of the true motion: RK4 at a quarter of its limit, on the GPU.
  double true_strain() {
    static std::map<std::string, double> known;
    const double end = whole_steps() * scene_.solver.dt;
    const std::string key = test_.name + format(" to %.2g s", end);
    const auto found = known.find(key);
    if (found != known.end()) return found->second;
    scene::Scene scene = scene_;
    scene.solver.method = scene::Method::rk4;
    scene.solver.dt = 0.25 * model::dt_limit(*model::build(scene), scene);
    auto simulation = sim::Simulation::create(scene);
    (*simulation)->step(static_cast<std::uint32_t>(end / scene.solver.dt + 0.5));
    return known[key] = (*simulation)->diagnose().max_strain;
  }

  void judge_stretch(const sim::State& state, Verdict& verdict) {
    for (const scene::Collider& collider : scene_.colliders) {
      const auto* plane = std::get_if<scene::Plane>(&collider.shape);
      for (const glm::vec3& x : state.position)
        if (plane && glm::dot(dvec3(x) - plane->point, plane->normal) < -1e-4)
          return static_cast<void>(fail(verdict, Ending::passes_through, "a vertex is below the table"));
    }
    if (!compared_) return;
    const double truth = true_strain();
    if (!(last_.max_strain < 2 * truth + 0.05))
      fail(verdict, Ending::overstretched,
           format("overstretched: strain %.3g ", last_.max_strain) + format("instead of %.3g", truth));
  }

  const Case& test_;
  const scene::Scene& scene_;
  bool compared_;
  sim::Diagnostics last_;
  double mass_ = 0;
  bool arrived_ = false;
};

}  // namespace clothlab::stress
