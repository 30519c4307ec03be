// Where each method fails: runs every stress scene (tests/stress) under every method, and turns up the
// scene's knob until the method fails; beside it the prediction. Usage: bench_stress [PART OF A CASE'S NAME
// [METHOD]]; it prints one JSON line for each. stress.mjs makes the table.
#include "server/gl/context.h"
#include "tests/bench/seed.h"
#include "tests/stress/predict.h"

using namespace clothlab;
using namespace clothlab::stress;

namespace {

struct Measured {
  double holds_at = 0, fails_from = 0;  ///< values of the knob; 0: never seen
  std::string how, at_worst;            ///< failure at fails_from, and at the worst value tried
  int runs = 0, at_rest_shape = 0, finished = 0;
  bool false_alarm = false, cut_short = false, in_order = true;
};

class Search {
 public:
  Search(const Case& test, const scene::Scene& base, double predicted)
      : test_(test), base_(base), predicted_(predicted) {}

  Measured run() {
    const bool by_limit = test_.knob.name == "dt" && !scene::any_step_is_stable(base_.solver.method);
    std::vector<double> values = test_.knob.values;
    if (by_limit) {
      values.clear();  // blow-ups end early: it costs little to start far above the limit
      const double least = predicted_ > 0 ? predicted_ / 8 : test_.seconds / 6e5;
      for (double dt = 1.0 / 30; dt > least; dt /= 4) values.push_back(dt);
    }
    for (const double value : values) {
      const bool held = holds(value);
      if (held && by_limit) break;
      if (held && test_.knob.name != "dt") break;
    }
    // A failure that only a shorter step cures.
    for (double dt = values.back() / 2;
         test_.knob.name == "dt" && !by_limit && result_.holds_at == 0 && dt > test_.seconds / 13000; dt /= 2)
      holds(dt);
    if (result_.in_order && result_.holds_at > 0 && result_.fails_from > 0) bisect(by_limit ? 1.04 : 1.15);
    return result_;
  }

 private:
  bool holds(double value) {
    bool all = true;
    std::string how;
    for (const std::uint32_t seed : test_.seeds) {
      scene::Scene scene = base_;
      test_.knob.set(scene, value);
      if (auto* scatter = std::get_if<scene::Scatter>(&scene.cloths[0].start)) scatter->seed = seed;
      const Verdict verdict = Trial(test_, scene).run();
      ++result_.runs;
      result_.false_alarm =
          result_.false_alarm || (verdict.alarm && value < 0.9 * predicted_ &&
                                  (verdict.ending == Ending::holds || verdict.ending == Ending::elsewhere));
      if (verdict.ending == Ending::holds) {
        result_.cut_short = result_.cut_short || verdict.cut_short;
        ++result_.finished;
        result_.at_rest_shape += verdict.at_rest_shape;
      } else if (all) {
        all = false;
        how = verdict.text;
      }
    }
    note(value, all, how);
    return all;
  }

  void note(double value, bool held, const std::string& how) {
    if (held) {
      if (result_.fails_from > 0 && value > result_.fails_from) result_.in_order = false;
      result_.holds_at = std::max(result_.holds_at, value);
      return;
    }
    if (value < result_.holds_at) result_.in_order = false;
    if (result_.at_worst.empty()) result_.at_worst = how;
    if (result_.fails_from == 0 || value < result_.fails_from) {
      result_.fails_from = value;
      result_.how = how;
    }
  }

  void bisect(double precision) {
    while (result_.in_order && result_.fails_from / result_.holds_at > precision)
      holds(std::sqrt(result_.fails_from * result_.holds_at));
  }

  const Case& test_;
  const scene::Scene& base_;
  double predicted_;
  Measured result_;
};

std::string number(double value) {
  if (!(value > 0) || std::isinf(value)) return value == 0 ? "0" : "null";
  return format("%.4g", value);
}

void study(const Case& test, Method method) {
  scene::Scene base = load(test.file);
  base.solver.method = method;
  const double start = bench::seconds();
  scene::Scene first = base;
  test.knob.set(first, test.knob.values.back());
  if (test.knob.name != "dt") base.solver.dt = first.solver.dt;
  const Prediction predicted = predict(test, base);
  const Measured found = Search(test, base, predicted.from).run();
  std::printf(
      "{\"case\": \"%s\", \"method\": \"%s\", \"knob\": \"%s\", \"unit\": \"%s\", \"worst\": %s, "
      "\"predicted_from\": %s, \"predicted_at_start\": %s, \"why\": \"%s\", \"fails_from\": %s, "
      "\"holds_at\": %s, \"how\": \"%s\", "
      "\"at_worst\": \"%s\", \"runs\": %d, \"held\": %d, \"at_rest_shape\": %d, \"in_order\": %s, "
      "\"cut_short\": %s, \"false_alarm\": %s, \"seconds\": %.1f}\n",
      test.name.c_str(), scene::name(method), test.knob.name.c_str(), test.knob.unit.c_str(),
      number(test.knob.values.front()).c_str(), number(predicted.from).c_str(),
      predicted.at_start > 0 ? number(predicted.at_start).c_str() : "null", predicted.why.c_str(),
      found.fails_from > 0 ? number(found.fails_from).c_str() : "null",
      found.holds_at > 0 ? number(found.holds_at).c_str() : "null", found.how.c_str(), found.at_worst.c_str(),
      found.runs, found.finished, found.at_rest_shape, found.in_order ? "true" : "false",
      found.cut_short ? "true" : "false", found.false_alarm ? "true" : "false", bench::seconds() - start);
  std::fflush(stdout);
}

/// Stretch of a hanging strip over the exact stretch, against iterations and dt.
void study_stretch(Method method) {
  for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120})
    for (const int iterations : {1, 10, 100}) {
      scene::Scene scene = load("strip");
      scene.solver = {method, dt, iterations, 1e-4};
      const auto simulation = sim::Simulation::create(scene);
      if (!simulation) return;
      (*simulation)->step(static_cast<std::uint32_t>(8.0 / dt));
      const double low = (*simulation)->read_state().position.back().y;
      // Each link bears the weight below it: m g (8 + 7 + ... + 1) / k in all.
      const double exact = 0.01 * 9.8 * 36 / 2000;
      std::printf(
          "{\"stretch\": true, \"method\": \"%s\", \"dt\": %.4g, \"iterations\": %d, \"predicted\": %.4g, "
          "\"measured\": %.4g}\n",
          scene::name(method), dt, iterations, method == Method::vbd ? 1.0 : Column(scene).stretch_ratio(),
          (2.0 - low - 1.0) / exact);
      std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  const std::string part = argc > 1 ? argv[1] : "", only = argc > 2 ? argv[2] : "";
  std::printf("{\"renderer\": \"%s\"}\n", (*context)->device().name.c_str());
  for (const Case& test : cases())
    for (const Method method : scene::methods)
      // At 1/30 s the methods with a step limit are far beyond it, at any value of the other knobs.
      if ((scene::any_step_is_stable(method) || test.knob.name == "dt" || test.knob.name == "distance") &&
          test.name.find(part) != std::string::npos && (only.empty() || only == scene::name(method)))
        study(test, method);
  for (const Method method : scene::methods)
    if (scene::sweeps(method) && (only.empty() || only == scene::name(method)) &&
        std::string("stretch").find(part) != std::string::npos)
      study_stretch(method);
}
