#include "server/sim/simulation.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/base/pieces.h"
#include "server/model/clean_start.h"
#include "server/model/size.h"
#include "server/sim/colliders.h"
#include "server/sim/near_pairs.h"
#include "server/sim/simulation_steps.h"
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

}  // namespace

Simulation::Simulation() : implementation_(std::make_unique<Implementation>()) {}
Simulation::~Simulation() = default;

Result<std::unique_ptr<Simulation>> Simulation::create(const scene::Scene& scene,
                                                       std::uint32_t topology_revision) {
  std::unique_ptr<Simulation> made(new Simulation);
  Implementation& self = *made->implementation_;
  if (Status fits = fits_device(scene); !fits) return fits.error();
  self.scene = scene;
  self.keyed = self.keyed_now(scene);
  Result<Kernels> kernels = Kernels::create(self.now());
  if (!kernels) return kernels.error();
  self.kernels = std::move(*kernels);
  Result<DiagnosticsPass> diagnostics = DiagnosticsPass::create(self.kernels.model.vertex_count());
  if (!diagnostics) return diagnostics.error();
  self.diagnostics = std::move(*diagnostics);
  Result<SceneOrder> scene_order = SceneOrder::create(self.kernels.places);
  if (!scene_order) return scene_order.error();
  self.scene_order = std::move(*scene_order);
  self.topology_revision = topology_revision;
  self.rest = rest_positions(self.kernels.model);
  self.state = StateBuffers(self.kernels.model, self.kernels.motions, self.kernels.body_places());
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
  std::unique_ptr<scene::KeyedScene> keyed = self.keyed_now(scene);
  const scene::Scene& next = keyed ? keyed->scene() : scene;
  if (depth == ChangeDepth::kernel) {
    Result<Kernels> kernels = Kernels::create(next);
    if (!kernels) return kernels.error();
    if (scene.collides(scene::ContactKind::surface) && !self.scene.collides(scene::ContactKind::surface))
      if (Status apart = model::check_present(model(), scene, read_state().position); !apart)
        return apart.error();
    const Whole whole;
    self.give_up_work();
    self.note_before_changes();
    self.take_kernels(std::move(*kernels));
  } else if (depth == ChangeDepth::uniform) {
    self.give_up_work();
    self.note_before_changes();
    if (Status updated = self.kernels.update(next); !updated) return updated.error();
  }
  self.adopt(scene, std::move(keyed));
  if (depth != ChangeDepth::none) self.undo_changes();
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
  const bool held_anew = self.keyed && self.keyed->release({});
  if (self.kernels.plan != sim::plan(self.now()) || held_anew)
    if (Result<Kernels> kernels = Kernels::create(self.now())) self.take_kernels(std::move(*kernels));
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
  self.hold_again();
}

KeptStates& Simulation::kept() {
  return implementation_->kept;
}
void Simulation::keep_state() {
  implementation_->give_up_work();
  implementation_->keep_state();
}
void Simulation::forget_carried() {
  implementation_->before_changes.reset();
  implementation_->kernels.forget();
}
bool Simulation::in_step() const {
  return implementation_->in_step;
}

Status Simulation::go_to_kept(std::uint64_t step, const scene::Scene& scene) {
  Implementation& self = *implementation_;
  const KeptState& then = *self.kept.at_or_before(step);
  std::unique_ptr<scene::KeyedScene> keyed = self.keyed_as(scene, then.released);
  const scene::Scene& next = keyed ? keyed->scene() : scene;
  Result<Kernels> kernels = Kernels::create(next);
  if (!kernels) return kernels.error();
  if (kernels->self_collision && kernels->plan.neighbour_slots != then.neighbour_slots)
    if (Status grown = kernels->grow(next, then.neighbour_slots); !grown) return grown.error();
  self.give_up_work();
  self.before_changes.reset();
  self.take_kernels(std::move(*kernels));
  self.scene = scene;
  self.keyed = std::move(keyed);
  (void)self.set_hands({});
  if (Status done = self.go_on_from(then); !done) return done;
  self.kept.drop_after(then.step);
  self.keep_start();
  return ok();
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
const Convergence& Simulation::convergence() const {
  return implementation_->convergence.last();
}
void Simulation::measure_convergence(bool on) {
  implementation_->convergence.measure_now_and_then(on);
}
void Simulation::measure_step(std::uint64_t step) {
  implementation_->convergence.ask(step);
}
double Simulation::measuring_seconds() const {
  return implementation_->convergence.seconds();
}
StrainLimitWork Simulation::strain_limit_work() const {
  return implementation_->kernels.strain_limit ? implementation_->kernels.strain_limit->work()
                                               : StrainLimitWork{};
}
std::uint64_t Simulation::dispatches() const {
  return implementation_->kernels.integrator->dispatches();
}

void Simulation::request_diagnostics() {
  implementation_->request_diagnostics();
}

bool Simulation::poll_diagnostics(Diagnostics& out, bool wait) {
  if (!implementation_->diagnostics.poll(out, wait)) return false;
  implementation_->diagnosed_step = out.step;
  implementation_->last_good.free_before(out.step);
  return true;
}

void Simulation::diagnose_every(std::uint32_t steps) {
  implementation_->diagnosed_every = steps;
}

Diagnostics Simulation::diagnose() {
  Diagnostics result;
  while (implementation_->diagnostics.poll(result, true)) {
  }  // take older results that are still on their way
  request_diagnostics();
  poll_diagnostics(result, true);
  return result;
}

void Simulation::restore(const State& state, double time, std::uint64_t step) {
  Implementation& self = *implementation_;
  self.give_up_work();
  self.state.write(self.scene_order.to_memory(state), self.kernels.model, self.kernels.motions);
  self.state_replaced(time, step);
  self.hold_again();
  self.keep_start();
}

State Simulation::read_state() {
  return implementation_->scene_order.to_scene(implementation_->state.read());
}
NearPairs Simulation::near_pairs() {
  return sim::near_pairs(implementation_->kernels, implementation_->now(), read_state(), time());
}
void Simulation::shorten_contact_lists(std::uint32_t entries, bool for_good) {
  if (implementation_->kernels.surface_contact)
    implementation_->kernels.surface_contact->shorten_lists(entries, for_good);
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
