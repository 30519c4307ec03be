// How a simulation goes on: the state, the kernels of its scene, and the batches of steps that run on them.
// What users of a simulation call is in simulation.cpp.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "server/gl/bindings.h"
#include "server/scene/method.h"
#include "server/sim/diagnose.h"
#include "server/sim/hands.h"
#include "server/sim/kept_states.h"
#include "server/sim/kernels.h"
#include "server/sim/last_good.h"
#include "server/sim/scene_order.h"
#include "server/sim/simulation.h"
#include "server/sim/state.h"

namespace clothlab::sim {

struct Simulation::Implementation {
  scene::Scene scene;
  Kernels kernels;
  SceneOrder scene_order;
  gl::TextureBuffer rest;
  StateBuffers state;
  Hands hands;
  std::vector<scene::Motion> settled;  ///< of pins with a place that came when the cloth was on its way
  DiagnosticsPass diagnostics;
  std::uint64_t diagnosed_step = 0;  ///< step_index of the diagnosis that arrived last
  LastGood last_good;
  KeptStates kept;
  std::uint32_t topology_revision = 0;
  std::uint64_t step_index = 0;
  // Time is start_time + (step_index - start_step) dt. A sum over the steps would drift by rounding. A change
  // of dt sets start_time and start_step to the present.
  double start_time = 0.0;
  std::uint64_t start_step = 0;
  std::vector<double> batch_times;
  std::uint32_t steps_to_do = 0;
  bool in_step = false;
  gl::StageTimer* next_timer = nullptr;
  gl::Bindings bound;  ///< what `work` had bound in GL when it stopped
  Work work;           ///< the batch of steps under way; must be the last member, as it refers to the others

  /// The time [s] at the start of step number `step`, or `share` of a step later.
  double time_of(std::uint64_t step, double share = 0.0) const {
    return start_time + (static_cast<double>(step - start_step) + share) * scene.solver.dt;
  }

  void bind_constants() const {
    kernels.elements.bind(unit_elements);
    kernels.slices.bind(unit_element_slices);
    rest.bind(unit_rest_position);
    if (!kernels.plan.wind) return;
    kernels.fan_offsets.bind(unit_fan_offsets);
    kernels.fans.bind(unit_fans);
  }

  void upload_poses(std::uint32_t steps) {
    if (kernels.motions.empty()) return;
    batch_times.clear();
    const int rows = kernels.plan.pose_rows();
    for (std::uint32_t step = 0; step < steps; ++step)
      for (int row = 0; row < rows; ++row)
        batch_times.push_back(time_of(step_index + step, static_cast<double>(row) / rows));
    batch_times.push_back(time_of(step_index + steps));
    kernels.motions.upload(batch_times);
    kernels.motions.bind(unit_motion_table);
  }

  Work run_step(int row, gl::StageTimer* timer) {
    const auto passed = [timer](const char* pass) {
      if (timer) timer->stage(pass);
    };
    hands.hold(state, scene);
    state.position().bind(unit_position);
    if (kernels.self_collision) {
      co_await kernels.update_lists(scene);
      passed("neighbour_search");
    }
    if (kernels.surface_contact) {
      co_await kernels.surface_contact->update_pairs(state, row);
      passed("pair_search");
    }
    co_await kernels.integrator->step(state, row);
    passed(scene::name(kernels.plan.method));
    if (kernels.strain_limit) {
      co_await kernels.strain_limit->apply(state, kernels.model);
      passed("strain_limit");
    }
    if (kernels.surface_contact) {
      kernels.surface_contact->keep_apart(state, row);
      passed("surface_contact");
    }
    hands.release(state);
  }

  /// Does up to `count` steps; ends earlier if no steps are left to do.
  Work run_batch(std::uint32_t count) {
    gl::StageTimer* timer = std::exchange(next_timer, nullptr);
    bind_constants();
    upload_poses(count);
    for (std::uint32_t step = 0; step < count && steps_to_do > 0; ++step) {
      if (timer) timer->begin();
      in_step = true;
      co_await run_step(static_cast<int>(step) * kernels.plan.pose_rows(), timer);
      if (timer) std::exchange(timer, nullptr)->end();
      in_step = false;
      state.show();
      ++step_index;
      --steps_to_do;
      if (kept.due(step_index)) keep_state();
      co_await may_stop;
    }
  }

  void resume(Pace& pace) {
    while (steps_to_do > 0) {
      if (work.done())
        work = run_batch(std::min(steps_to_do, batch_steps));
      else
        bound.restore();
      work.resume(pace);
      if (work.done()) continue;
      bound = gl::Bindings::current();
      return;
    }
  }

  /// Gives up the batch under way, with any step that it has begun, and leaves no steps to do.
  void give_up_work() {
    steps_to_do = 0;
    work = Work();
    if (!std::exchange(in_step, false)) return;
    state.give_up_step();
    forget();
  }

  /// Makes all passes forget what they carry over from step to step, which belongs to another state.
  void forget() {
    if (kernels.self_collision) kernels.self_collision->invalidate();
    kernels.integrator->restart();
    if (kernels.strain_limit) kernels.strain_limit->restart();
    if (kernels.surface_contact) kernels.surface_contact->invalidate();
  }

  /// To be called when the state was set from outside and not made by a step: passes forget what they carry
  /// over, and time and step number are set.
  void state_replaced(double time, std::uint64_t step) {
    forget();
    start_time = time;
    step_index = start_step = step;
  }

  /// Keeps the state at the end of a step. The run goes on from it as one that goes back to it does.
  void keep_state() {
    forget();
    kept.keep(state, kernels.model.vertex_count(),
              {{},
               {},
               step_index,
               time_of(step_index),
               start_time,
               start_step,
               settled,
               kernels.plan.neighbour_slots});
  }

  /// Makes the present state the good state.
  void keep_start() {
    last_good.put_aside(state, time_of(step_index), step_index);
    last_good.keep(step_index);
  }

  template <class Part>
  static bool differs(const scene::Scene& from, const scene::Scene& to, Part part) {
    return !std::equal(from.cloths.begin(), from.cloths.end(), to.cloths.begin(), to.cloths.end(),
                       [&](const scene::Cloth& a, const scene::Cloth& b) { return a.*part == b.*part; });
  }

  /// Pins with a place that come while the cloth is on its way are there at once: a hand has taken them
  /// there.
  void settle_new_pins(const scene::Scene& next) {
    const std::vector<scene::Motion> known = moving_motions(scene);
    for (const scene::Motion& motion : moving_motions(next))
      if (step_index > 0 && std::find(known.begin(), known.end(), motion) == known.end())
        settled.push_back(motion);
    std::erase_if(settled,
                  [](const scene::Motion& motion) { return !std::holds_alternative<scene::Placed>(motion); });
    kernels.motions.settle(settled);
  }

  void take_kernels(Kernels next) {
    kernels = std::move(next);
    state.make_room(kernels.body_places());
  }

  /// Takes over a changed scene; positions, velocities and time stay as they are.
  void adopt(const scene::Scene& next) {
    if (next.solver.dt != scene.solver.dt) {
      start_time = time_of(step_index);
      start_step = step_index;
    }
    const bool constants =
        differs(scene, next, &scene::Cloth::mass) || differs(scene, next, &scene::Cloth::weights) ||
        differs(scene, next, &scene::Cloth::pins) || moving_motions(scene) != moving_motions(next);
    settle_new_pins(next);
    scene = next;
    if (constants) state.rewrite_constants(kernels.model, kernels.motions);
    if (!hands.empty())
      (void)set_hands(hands.all());  // masses and pins may have changed; the kernels are there
  }

  Status set_hands(std::vector<Hand> next) {
    return hands.set(std::move(next), kernels.model, kernels.places);
  }
};

}  // namespace clothlab::sim
