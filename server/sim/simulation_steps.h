// How a simulation goes on: the state, the kernels of its scene, and the batches of steps that run on them.
// What users of a simulation call is in simulation.cpp.
#pragma once

#include <algorithm>
#include <glm/vec4.hpp>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "server/base/pieces.h"
#include "server/gl/bindings.h"
#include "server/scene/keys.h"
#include "server/scene/method.h"
#include "server/sim/convergence.h"
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
  std::unique_ptr<scene::KeyedScene> keyed;  ///< `scene` as its keys make it; null: it has none
  Kernels kernels;                           ///< of `now()`
  SceneOrder scene_order;
  gl::TextureBuffer rest;
  StateBuffers state;
  Hands hands;
  std::vector<scene::Motion> settled;  ///< of pins with a place that came when the cloth was on its way
  DiagnosticsPass diagnostics;
  std::uint64_t diagnosed_step = 0;  ///< step_index of the diagnosis that arrived last
  std::uint32_t diagnosed_every = 0;
  LastGood last_good;
  KeptStates kept;
  ConvergenceMeasure convergence;
  /// What methods carry, at the start of the step under way if that may be cut; else empty.
  Carried at_step_start;
  bool may_be_cut = false, has_step_start = false;
  /// The scene before the changes since the last step, and the state under it: a change back goes on from
  /// there.
  struct BeforeChanges {
    scene::Scene scene;
    KeptState state;
  };
  std::optional<BeforeChanges> before_changes;
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

  /// The scene that the kernels are at.
  const scene::Scene& now() const { return keyed ? keyed->scene() : scene; }

  /// The scene `next` with its keys as at the present time, in which the pins that have let go still have;
  /// null: neither is there.
  std::unique_ptr<scene::KeyedScene> keyed_now(const scene::Scene& next) const {
    return keyed_as(next, keyed ? keyed->released() : std::vector<scene::KeyedScene::LetGo>{});
  }
  std::unique_ptr<scene::KeyedScene> keyed_as(const scene::Scene& next,
                                              const std::vector<scene::KeyedScene::LetGo>& released) const {
    if (next.keys.empty() && released.empty()) return nullptr;
    auto made = std::make_unique<scene::KeyedScene>(next);
    made->set(time_of(step_index), time_of(step_index));
    made->release(released);
    return made;
  }

  /// Sets keyed values: those of forces as of `share` of the step under way, those of contacts as of its end.
  void set_keyed(double share) {
    const scene::KeyedScene::Changed changed =
        keyed->set(time_of(step_index, share), time_of(step_index, 1.0));
    if (!changed.any()) return;
    kernels.take_keyed(keyed->scene(), changed);
    if (changed.materials) bind_constants();
  }

  /// Makes the kernels anew, as pins have let go, or hold again where the state went back. If they cannot be
  /// made, the next batch of steps tries again.
  void follow_holds(const std::vector<scene::KeyedScene::LetGo>& before) {
    const Whole whole;
    Result<Kernels> made = Kernels::create(keyed->scene());
    if (!made) {
      keyed->release(before);
      return;
    }
    made->motions.settle(settled);
    take_kernels(std::move(*made));
    state.rewrite_constants(kernels.model, kernels.motions);
    if (!hands.empty()) (void)set_hands(hands.all());
  }

  /// To be called before a batch of steps: lets go of the pins whose keys say so.
  void let_go() {
    if (!keyed) return;
    const std::vector<scene::KeyedScene::LetGo> before = keyed->released();
    if (keyed->let_go(time_of(step_index)).holds) follow_holds(before);
  }

  /// To be called when the state is another step's: pins that let go only after it hold again.
  void hold_again() {
    if (!keyed) return;
    const std::vector<scene::KeyedScene::LetGo> before = keyed->released();
    if (keyed->hold_again(time_of(step_index, -1.0))) follow_holds(before);
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
    state.position().bind(unit_position);
    if (keyed) set_keyed(scene::forces_after(kernels.plan.method));
    if (kernels.surface_contact) {
      co_await kernels.surface_contact->update_pairs(state, row);
      passed("pair_search");
    }
    // After it: the step itself asks for the next search of neighbours, and both searches bind at the same
    // places.
    if (kernels.self_collision) {
      state.position().bind(unit_position);
      co_await kernels.update_lists(now());
      passed("neighbour_search");
    }
    hands.hold(state, now());
    kernels.integrator->set_stage_watch(keyed ? [this](double share) { set_keyed(share); }
                                              : std::function<void(double)>());
    kernels.integrator->set_contact(kernels.plan.contact_term() ? &*kernels.surface_contact : nullptr);
    kernels.integrator->set_held(!hands.empty());
    if (convergence.due(step_index)) co_await convergence.measure(state, kernels, now(), row, step_index);
    state.position().bind(unit_position);
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
    let_go();
    bind_constants();
    upload_poses(count);
    for (std::uint32_t step = 0; step < count && steps_to_do > 0; ++step) {
      if (timer) timer->begin();
      begin_step();
      co_await run_step(static_cast<int>(step) * kernels.plan.pose_rows(), timer);
      if (timer) std::exchange(timer, nullptr)->end();
      in_step = has_step_start = false;
      kernels.end_step();
      state.show();
      ++step_index;
      --steps_to_do;
      if (kept.due(step_index)) keep_state();
      if (diagnosed_every > 0 && step_index % diagnosed_every == 0) request_diagnostics();
      co_await may_stop;
      if (keyed && keyed->lets_go(time_of(step_index))) co_return;
    }
  }

  void request_diagnostics() {
    bind_constants();
    const SelfCollision* self_collision = kernels.self_collision ? &*kernels.self_collision : nullptr;
    const SurfaceContact* surfaces = kernels.surface_contact ? &*kernels.surface_contact : nullptr;
    diagnostics.request(state, self_collision, surfaces, scene::gravity_at(scene, time_of(step_index)),
                        time_of(step_index), step_index);
    last_good.put_aside(state, time_of(step_index), step_index);
  }

  void begin_step() {
    before_changes.reset();
    in_step = true;
    if (!may_be_cut) return;
    Carrier carrier = Carrier::to(at_step_start);
    kernels.carry_method(carrier);
    has_step_start = true;
  }

  void resume(Pace& pace) {
    may_be_cut = pace.limited();
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

  /// Gives up the batch under way, with any step that it has begun, and leaves no steps to do. All is as if
  /// that step had not begun.
  void give_up_work() {
    steps_to_do = 0;
    work = Work();
    if (!std::exchange(in_step, false)) return;
    state.give_up_step();
    kernels.give_up_step();
    if (!std::exchange(has_step_start, false)) return kernels.forget();
    Carrier carrier = Carrier::from(at_step_start);
    kernels.carry_method(carrier);
  }

  /// To be called when the state was set from outside and not made by a step: passes forget what they carry
  /// over, and time and step number are set.
  void state_replaced(double time, std::uint64_t step) {
    before_changes.reset();
    kernels.forget();
    start_time = time;
    step_index = start_step = step;
    convergence.begin(step);
  }

  /// Copies all that the next step depends on besides the scene. Not to be called within a step.
  void copy_to(KeptState& copy) {
    const std::size_t size = kernels.model.vertex_count() * sizeof(glm::vec4);
    for (gl::Buffer* buffer : {&copy.position, &copy.velocity})
      if (buffer->bytes() != size) *buffer = gl::Buffer(size);
    state.save(copy.position, copy.velocity);
    Carrier carrier = Carrier::to(copy.carried);
    kernels.carry(carrier);
    copy.step = step_index;
    copy.time = time_of(step_index);
    copy.start_time = start_time;
    copy.start_step = start_step;
    copy.settled = settled;
    copy.released = keyed ? keyed->released() : std::vector<scene::KeyedScene::LetGo>{};
    copy.neighbour_slots = kernels.plan.neighbour_slots;
  }

  /// Goes on from a copy, under the scene that it was made under. Error: the kernels cannot be made, and
  /// nothing has changed.
  Status go_on_from(const KeptState& copy) {
    if (kernels.self_collision && kernels.plan.neighbour_slots != copy.neighbour_slots)
      if (Status grown = kernels.grow(now(), copy.neighbour_slots); !grown) return grown;
    settled = copy.settled;
    kernels.motions.settle(settled);
    state.load(copy.position, copy.velocity);
    start_time = copy.start_time;
    start_step = copy.start_step;
    step_index = copy.step;
    bind_constants();
    Carrier carrier = Carrier::from(copy.carried);
    kernels.carry(carrier);
    if (!carrier.fits()) kernels.forget();
    return ok();
  }

  void keep_state() {
    kept.keep([this](KeptState& copy) { copy_to(copy); });
  }

  /// To be called before a change of scene, when no step is under way.
  void note_before_changes() try {
    if (before_changes) return;
    before_changes.emplace(BeforeChanges{scene, {}});
    copy_to(before_changes->state);
  } catch (const std::bad_alloc&) {  // then the next step begins with new lists and first guesses
    before_changes.reset();
  }
  /// To be called after a change of scene: if it ends where the changes began, nothing has changed.
  void undo_changes() {
    if (!before_changes || change_depth(before_changes->scene, scene) != ChangeDepth::none) return;
    (void)go_on_from(before_changes->state);
    before_changes.reset();
  }

  /// Makes the present state the good state.
  void keep_start() {
    last_good.free_before(std::numeric_limits<std::uint64_t>::max());
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
    convergence.forget_solver();
    convergence.begin(step_index);
    state.make_room(kernels.body_places());
  }

  /// Takes over a changed scene; positions, velocities and time stay as they are.
  void adopt(const scene::Scene& next, std::unique_ptr<scene::KeyedScene> next_keyed) {
    if (next.solver.dt != scene.solver.dt) {
      start_time = time_of(step_index);
      start_step = step_index;
    }
    const bool constants =
        differs(scene, next, &scene::Cloth::mass) || differs(scene, next, &scene::Cloth::weights) ||
        differs(scene, next, &scene::Cloth::pins) || moving_motions(scene) != moving_motions(next);
    settle_new_pins(next);
    keyed = std::move(next_keyed);
    if (next.solver != scene.solver) convergence.begin(step_index);
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
