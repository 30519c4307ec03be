#include "server/sim/simulation.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/gl/bindings.h"
#include "server/model/clean_start.h"
#include "server/model/size.h"
#include "server/scene/method.h"
#include "server/sim/colliders.h"
#include "server/sim/diagnose.h"
#include "server/sim/hands.h"
#include "server/sim/kernels.h"
#include "server/sim/last_good.h"
#include "server/sim/scene_order.h"
#include "server/sim/state.h"

namespace clothlab::sim {

namespace {

gl::TextureBuffer rest_positions(const model::Model& model) {
  std::vector<float> words;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i) {
    for (int axis = 0; axis < 3; ++axis) words.push_back(static_cast<float>(model.rest_position[i][axis]));
    words.push_back(static_cast<float>(model.vertex_cloth[i]));
  }
  return {gl::Buffer(words), GL_RGBA32F};
}

/// Error: the device cannot hold the scene's largest buffer. To be checked before any buffer is made.
Status fits_device(const scene::Scene& scene) {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  const model::Size size = model::size_of(scene);
  const std::size_t wanted = std::max(size.vertices, size.list_texels());
  if (wanted <= static_cast<std::size_t>(texels)) return ok();
  return Error{
      "/cloths",
      std::to_string(size.vertices) + " vertices and " + std::to_string(size.all_elements()) + " elements",
      "lists of at most " + std::to_string(texels) +
          " entries on this device (GL_MAX_TEXTURE_BUFFER_SIZE): a coarser mesh, or fewer elements"};
}

template <class Part>
bool differs(const scene::Scene& from, const scene::Scene& to, Part part) {
  return !std::equal(from.cloths.begin(), from.cloths.end(), to.cloths.begin(), to.cloths.end(),
                     [&](const scene::Cloth& a, const scene::Cloth& b) { return a.*part == b.*part; });
}

}  // namespace

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
      co_await kernels.strain_limit->apply(state);
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

  /// Makes the present state the good state.
  void keep_start() {
    last_good.put_aside(state, time_of(step_index), step_index);
    last_good.keep(step_index);
  }

  void settle_new_pins(const scene::Scene& next) {
    const std::vector<scene::Motion> known = moving_motions(scene);
    for (const scene::Motion& motion : moving_motions(next))
      if (step_index > 0 && std::find(known.begin(), known.end(), motion) == known.end())
        settled.push_back(motion);
    std::erase_if(settled,
                  [](const scene::Motion& motion) { return !std::holds_alternative<scene::Placed>(motion); });
    kernels.motions.settle(settled);
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

Simulation::Simulation() : implementation_(std::make_unique<Implementation>()) {}
Simulation::~Simulation() = default;

Result<std::unique_ptr<Simulation>> Simulation::create(const scene::Scene& scene,
                                                       std::uint32_t topology_revision) {
  std::unique_ptr<Simulation> made(new Simulation);
  Implementation& self = *made->implementation_;
  if (Status fits = fits_device(scene); !fits) return fits.error();
  Result<Kernels> kernels = Kernels::create(scene);
  if (!kernels) return kernels.error();
  self.kernels = std::move(*kernels);
  Result<DiagnosticsPass> diagnostics = DiagnosticsPass::create(self.kernels.model.vertex_count());
  if (!diagnostics) return diagnostics.error();
  self.diagnostics = std::move(*diagnostics);
  Result<SceneOrder> scene_order = SceneOrder::create(self.kernels.places);
  if (!scene_order) return scene_order.error();
  self.scene_order = std::move(*scene_order);
  self.scene = scene;
  self.topology_revision = topology_revision;
  self.rest = rest_positions(self.kernels.model);
  self.state = StateBuffers(self.kernels.model, self.kernels.motions,
                            self.kernels.surface_contact ? self.kernels.surface_contact->extra_places() : 0);
  self.last_good = LastGood(self.kernels.model.vertex_count());
  self.keep_start();
  return made;
}

Result<ChangeDepth> Simulation::change(const scene::Scene& scene) {
  Implementation& self = *implementation_;
  const ChangeDepth depth = change_depth(self.scene, scene);
  if (depth == ChangeDepth::cloth) {
    Result<std::unique_ptr<Simulation>> fresh = create(scene, self.topology_revision + 1);
    if (!fresh) return fresh.error();
    implementation_ = std::move((*fresh)->implementation_);
    return depth;
  }
  if (depth == ChangeDepth::kernel) {
    Result<Kernels> kernels = Kernels::create(scene);
    if (!kernels) return kernels.error();
    if (scene.collides(scene::ContactKind::surface) && !self.scene.collides(scene::ContactKind::surface))
      if (Status apart = model::check_present(model(), scene, read_state().position); !apart)
        return apart.error();
    self.give_up_work();
    self.kernels = std::move(*kernels);
  } else if (depth == ChangeDepth::uniform) {
    self.give_up_work();
    if (Status updated = self.kernels.update(scene); !updated) return updated.error();
  }
  self.adopt(scene);
  return depth;
}

Status Simulation::set_hands(std::vector<Hand> hands) {
  Implementation& self = *implementation_;
  if (!self.hands.same_holds(hands) && self.in_step) self.give_up_work();
  return self.set_hands(std::move(hands));
}

void Simulation::step(std::uint32_t count, gl::StageTimer* timer) {
  set_steps_to_do(count, timer);
  Pace unlimited;
  while (steps_to_do() > 0) resume(unlimited);
}

void Simulation::set_steps_to_do(std::uint32_t count, gl::StageTimer* timer) {
  implementation_->steps_to_do = count;
  implementation_->next_timer = timer;
}

std::uint32_t Simulation::steps_to_do() const {
  return implementation_->steps_to_do;
}

void Simulation::resume(Pace& pace) {
  implementation_->resume(pace);
}

void Simulation::reset() {
  Implementation& self = *implementation_;
  self.give_up_work();
  // Kernels whose neighbour lists have grown are made anew: then the same steps follow as at the start.
  if (self.kernels.plan != sim::plan(self.scene))
    if (Result<Kernels> kernels = Kernels::create(self.scene)) self.kernels = std::move(*kernels);
  self.settled.clear();
  self.kernels.motions.settle({});
  self.state.reset(self.kernels.model, self.kernels.motions);
  self.state_replaced(0.0, 0);
  self.keep_start();
}

void Simulation::keep_diagnosed() {
  implementation_->last_good.keep(implementation_->diagnosed_step);
}

void Simulation::go_back() {
  Implementation& self = *implementation_;
  self.give_up_work();
  const LastGood::When when = self.last_good.restore(self.state);
  self.state.rewrite_constants(self.kernels.model, self.kernels.motions);  // masses and pins may have changed
  self.state_replaced(when.time, when.step);
}

double Simulation::time() const {
  return implementation_->time_of(implementation_->step_index);
}
std::uint64_t Simulation::step_index() const {
  return implementation_->step_index;
}
const scene::Scene& Simulation::scene() const {
  return implementation_->scene;
}
const model::Model& Simulation::model() const {
  return implementation_->kernels.scene_model();
}
std::uint32_t Simulation::topology_revision() const {
  return implementation_->topology_revision;
}
std::vector<Simulation::Part> Simulation::parts() const {
  return sim::parts(implementation_->kernels.plan);
}

double Simulation::search_candidates() const {
  const std::optional<SelfCollision>& self_collision = implementation_->kernels.self_collision;
  return self_collision ? self_collision->candidates() : 0.0;
}

SolverWork Simulation::solver_work() const {
  return implementation_->kernels.integrator->work();
}
StrainLimitWork Simulation::strain_limit_work() const {
  return implementation_->kernels.strain_limit ? implementation_->kernels.strain_limit->work()
                                               : StrainLimitWork{};
}
std::uint64_t Simulation::dispatches() const {
  return implementation_->kernels.integrator->dispatches();
}

void Simulation::request_diagnostics() {
  Implementation& self = *implementation_;
  self.bind_constants();
  const SelfCollision* self_collision = self.kernels.self_collision ? &*self.kernels.self_collision : nullptr;
  const SurfaceContact* surfaces = self.kernels.surface_contact ? &*self.kernels.surface_contact : nullptr;
  if (self.diagnostics.request(self.state, self_collision, surfaces, self.scene.gravity, time(),
                               self.step_index))
    self.last_good.put_aside(self.state, time(), self.step_index);
}

bool Simulation::poll_diagnostics(Diagnostics& out) {
  if (!implementation_->diagnostics.poll(out, false)) return false;
  implementation_->diagnosed_step = out.step;
  return true;
}

Diagnostics Simulation::diagnose() {
  Diagnostics result;
  while (implementation_->diagnostics.poll(result, true)) {
  }  // take older results that are still on their way
  request_diagnostics();
  implementation_->diagnostics.poll(result, true);
  implementation_->diagnosed_step = result.step;
  return result;
}

void Simulation::restore(const State& state, double time, std::uint64_t step) {
  Implementation& self = *implementation_;
  self.give_up_work();
  self.state.write(self.scene_order.to_memory(state), self.kernels.model, self.kernels.motions);
  self.state_replaced(time, step);
  self.keep_start();
}

State Simulation::read_state() {
  return implementation_->scene_order.to_scene(implementation_->state.read());
}
void Simulation::finish() {
  glFinish();
}
void Simulation::bind_positions(unsigned unit) const {
  implementation_->scene_order.to_scene(implementation_->state.shown_position()).bind(unit);
}

bool Simulation::bind_vertices() const {
  implementation_->bind_constants();
  implementation_->state.shown_position().bind(unit_position);
  implementation_->state.shown_velocity().bind(unit_velocity);
  return implementation_->scene_order.bind_places();
}

std::vector<scene::Collider> Simulation::colliders_now() const {
  return colliders_at(implementation_->scene, time());
}

}  // namespace clothlab::sim
