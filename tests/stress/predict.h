// Predictions for each method in each stress scene, from formulas alone: written before the scenes were run.
#pragma once

#include <limits>

#include "server/model/constraint_gains.h"
#include "server/model/stability.h"
#include "tests/stress/trial.h"

namespace clothlab::stress {

using scene::Method;

inline constexpr double never = std::numeric_limits<double>::infinity();

/// The value of the case's knob from which a method is expected to fail, and why.
struct Prediction {
  double from = never;  ///< `never`: at no value
  std::string why;
  double at_start =
      0;  ///< or from here on already, as the start's long springs are stiff across; 0: the same
};

/// One column of a cloth that hangs as a chain: links of structural and shear springs, and bend springs over
/// two links. Steps it by PBD or XPBD, in one dimension and double precision, until it hangs still.
class Column {
 public:
  explicit Column(const scene::Scene& scene) : scene_(scene) {
    const scene::Cloth& cloth = scene.cloths[0];
    const auto& grid = std::get<scene::Grid>(cloth.mesh);
    links_ = grid.rows - 1;
    length_ = grid.height / links_;
    mass_.assign(static_cast<std::size_t>(grid.rows), cloth.mass.value);
    if (!cloth.weights.empty()) mass_.back() += cloth.weights[0].mass;
    for (int first : {0, 1})
      for (int top = first; top < links_; top += 2)
        springs_.push_back({top, top + 1, length_, cloth.springs().structural + cloth.springs().shear});
    for (int first : {0, 1, 2, 3})
      for (int top = first; cloth.springs().bend > 0 && top + 2 <= links_; top += 4)
        springs_.push_back({top, top + 2, 2 * length_, cloth.springs().bend});
  }

  /// RMS distance [m] between the hanging column under the scene's method and its exact balance.
  double error() const {
    const std::vector<double> found = hung(), exact = balanced();
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) sum += (found[i] - exact[i]) * (found[i] - exact[i]);
    return std::sqrt(sum / static_cast<double>(found.size()));
  }
  /// The column's stretch under the scene's method, over the exact stretch.
  double stretch_ratio() const {
    const double whole = length_ * links_;
    return (hung().back() - whole) / (balanced().back() - whole);
  }

 private:
  struct Link {
    int top, bottom;
    double length, stiffness;
  };

  std::vector<double> at_rest() const {
    std::vector<double> x;
    for (int i = 0; i <= links_; ++i) x.push_back(length_ * i);
    return x;
  }

  /// Gauss-Seidel on the balance of forces, which is linear here.
  std::vector<double> balanced() const {
    std::vector<double> x = at_rest();
    for (int sweep = 0; sweep < 20000; ++sweep)
      for (int i = 1; i <= links_; ++i) {
        const auto at = static_cast<std::size_t>(i);
        double force = mass_[at] * 9.8, stiffness = 0.0;
        for (const Link& link : springs_) {
          if (link.top != i && link.bottom != i) continue;
          const double tension = link.stiffness * (x[static_cast<std::size_t>(link.bottom)] -
                                                   x[static_cast<std::size_t>(link.top)] - link.length);
          force += link.top == i ? tension : -tension;
          stiffness += link.stiffness;
        }
        x[at] += force / stiffness;
      }
    return x;
  }

  std::vector<double> hung() const {
    const double dt = scene_.solver.dt, drag = 1 / (1 + dt * scene_.air_drag);
    std::vector<double> x = balanced(), v(x.size(), 0.0), d(x.size()), pushed(springs_.size());
    const auto mobility = [&](int i) { return i == 0 ? 0.0 : drag / mass_[static_cast<std::size_t>(i)]; };
    for (int step = 0; step < 3000; ++step) {
      for (std::size_t i = 1; i < x.size(); ++i) d[i] = drag * (dt * v[i] + dt * dt * 9.8);
      pushed.assign(springs_.size(), 0.0);
      for (int sweep = 0; sweep < scene_.solver.iterations; ++sweep)
        for (std::size_t s = 0; s < springs_.size(); ++s) {
          const Link& link = springs_[s];
          const auto a = static_cast<std::size_t>(link.bottom), b = static_cast<std::size_t>(link.top);
          const double w = mobility(link.bottom) + mobility(link.top), moved = d[a] - d[b];
          const elements::ConstraintGains gains =
              model::constraint_gains(scene_.solver, link.stiffness, scene_.cloths[0].springs().damping, w);
          const double now = x[a] - x[b] + moved;
          const double push =
              -(gains.stretch * (now - link.length) + gains.damping * moved + gains.memory * pushed[s]);
          pushed[s] += push;
          d[a] += mobility(link.bottom) * push;
          d[b] -= mobility(link.top) * push;
        }
      double most = 0.0;
      for (std::size_t i = 1; i < x.size(); ++i) {
        x[i] += d[i];
        v[i] = d[i] / dt;
        most = std::max(most, std::abs(d[i]));
      }
      if (step > 10 && most < 1e-9) break;
    }
    return x;
  }

  const scene::Scene& scene_;
  int links_ = 0;
  double length_ = 0;         ///< of a link [m]
  std::vector<double> mass_;  ///< [links + 1] [kg]
  std::vector<Link> springs_;
};

/// Smallest value of the knob for which `fails`, between its ends; `never` if the worst value does not fail.
template <class Fails>
double threshold(const Case& test, const scene::Scene& base, double best, Fails fails) {
  const auto at = [&](double value) {
    scene::Scene scene = base;
    test.knob.set(scene, value);
    return fails(scene);
  };
  double bad = test.knob.values.front(), good = best;
  if (!at(bad)) return never;
  while (bad / good > 1.02) {
    const double middle = std::sqrt(bad * good);
    (at(middle) ? bad : good) = middle;
  }
  return bad;
}

/// The sharp step limit [s] about the rest shape.
inline double limit_of(const scene::Scene& scene) {
  return model::dt_limit(*model::build(scene), scene);
}

inline Prediction predict_limited(const Case& test, const scene::Scene& base) {
  if (test.knob.name == "distance")
    return {still * base.solver.dt * 0x1p23, "the last bit of a place, 2^-23 of it, flickers once a step"};
  scene::Scene scene = base;
  test.knob.set(scene, test.knob.values.back());
  const model::Model model = *model::build(scene);
  const double limit = limit_of(scene);
  if (limit == 0.0) return {0.0, "without damping each step adds (omega dt)^2 to the energy of a vibration"};
  const double tense =
      model::dt_limit(scene.solver.method, model::ElementOperator(model, scene, model.start_position));
  if (tense < 0.99 * limit)
    return {limit, "step limit of the stiffest vibration: the first at the start, whose springs are long",
            tense};
  return {limit, "step limit of the stiffest vibration"};
}

/// Step [s] at which VBD's sweeps reach along a cloth of N links in a row: N sqrt(n m / k).
inline double reach_of_sweeps(const scene::Scene& scene) {
  const scene::Cloth& cloth = scene.cloths[0];
  return (std::get<scene::Grid>(cloth.mesh).rows - 1) *
         std::sqrt(scene.solver.iterations * cloth.mass.value / cloth.springs().structural);
}

inline Prediction predict_settling(const Case& test, const scene::Scene& base) {
  if (test.knob.name == "distance")
    return {still * base.solver.dt * 0x1p23, "the last bit of a place, 2^-23 of it, flickers once a step"};
  const Method method = base.solver.method;
  const double best = test.knob.name == "dt" ? 1e-5 : test.knob.values.back();
  if (scene::solves(method)) return {never, "no limit: each linear system is positive definite"};
  if (method == Method::vbd)
    return {
        threshold(test, base, best, [](const scene::Scene& s) { return s.solver.dt > reach_of_sweeps(s); }),
        "what the sweeps do not reach keeps the motion of the guess: dt > N sqrt(n m / k)"};
  const char* why =
      method == Method::pbd
          ? "its springs are softer, the more of them and the longer the step: a column of them says"
          : "the sweeps end before a column's load has come up to its pin";
  return {threshold(test, base, best, [](const scene::Scene& s) { return Column(s).error() > near; }), why};
}

inline Prediction predict(const Case& test, const scene::Scene& base) {
  const Method method = base.solver.method;
  if (!scene::any_step_is_stable(method)) return predict_limited(test, base);
  switch (test.check) {
    case Check::settles:
      return predict_settling(test, base);
    case Check::untangles:
      return {never,
              "no explosion; long steps damp the motion that shakes folds out, so it may stay crumpled"};
    case Check::bounded:
      return {never, "the method takes energy out by itself"};
    case Check::falls:
      return {never, "springs at their lengths do nothing; off by g t dt / 2"};
    case Check::struck: {
      const auto& sphere = std::get<scene::Sphere>(base.colliders[0].shape);
      scene::Scene scene = base;
      test.knob.set(scene, test.knob.values[0]);
      const double speed = std::get<scene::Linear>(scene.colliders[0].motion).velocity.z;
      return {never, format("paths are swept: end points alone would miss it from %.2g s",
                            2 * sphere.radius / speed)};
    }
    case Check::pulled:
      return {never, method == Method::pbd ? "holds, stretched more than its springs would be" : "holds"};
  }
  return {};
}

}  // namespace clothlab::stress
