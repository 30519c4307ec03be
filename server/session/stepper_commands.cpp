#include <algorithm>
#include <new>
#include <utility>

#include "server/model/constraint_gains.h"
#include "server/model/thickness.h"
#include "server/scene/named_fabric.h"
#include "server/session/stepper.h"

namespace clothlab::session {

void Stepper::handle(Command& command) {
  try {
    std::visit([&](auto& what) { perform(what, command.ticket); }, command.what);
  } catch (const std::bad_alloc&) {
    // All new objects have been freed, and the old ones are unchanged.
    const Error error{"session", "there is not enough memory for that", "a smaller scene, or fewer sessions"};
    if (command.ticket.id)
      reply(command.ticket, Refusal{Refusal::Reason::failed, error});
    else if (const auto* what = std::get_if<Export>(&command.what))
      exchange_.emit(Captured{command.ticket.asker, *what, error});
  }
}

void Stepper::reply(const Ticket& ticket, Answer answer) {
  if (ticket.id) exchange_.emit(Reply{ticket, std::move(answer)});
}

json Stepper::where_we_are() const {
  return {{"playing", run_.plays()}, {"time", simulation().time()}, {"step", simulation().step_index()}};
}

Refusal Stepper::diverged_refusal() {
  return {Refusal::Reason::diverged,
          {"", "the simulation has diverged",
           "send the remedy's patch or another, or use sim.reset or scene.load"}};
}

void Stepper::perform(GetScene&, const Ticket& ticket) {
  reply(ticket, json{{"document", document_.value}, {"revision", revision_}});
}

void Stepper::perform(LoadScene& load, const Ticket& ticket) {
  Result<scene::Document> document = load.preset.empty() ? scene::validate(std::move(load.document), meshes_)
                                                         : scene::load_preset(load.preset, meshes_);
  if (!document && !load.preset.empty())
    return reply(ticket, invalid_value({"/preset", json(load.preset).dump(), document.error().remedy}));
  if (!document) return reply(ticket, invalid_value(document.error()));
  const Result<scene::Scene> scene = prepare(*document);
  if (!scene) return reply(ticket, invalid_value(scene.error()));
  const Result<sim::ChangeDepth> depth = change_engine(*scene);
  if (!depth) return reply(ticket, invalid_value(depth.error()));
  run_.go_on();  // after a blow-up the new scene plays or is paused as the old one was before
  adopt(std::move(*document), *depth);
  // A loaded scene always starts at its beginning, however little it differs from the old one.
  if (*depth != sim::ChangeDepth::cloth) restart();
  reply(ticket, json{{"revision", revision_}, {"applies", sim::name(sim::ChangeDepth::cloth)}});
  announce_scene(std::nullopt, ticket.asker);
}

void Stepper::perform(PatchScene& patch, const Ticket& ticket) {
  if (patch.revision && *patch.revision != revision_)
    return reply(ticket, Refusal{Refusal::Reason::other_revision,
                                 {"",
                                  "the scene is at revision " + std::to_string(revision_) + ", not " +
                                      std::to_string(*patch.revision),
                                  "get the scene and patch that"},
                                 revision_});
  Result<scene::Document> document = scene::apply_patch(document_, patch.patch);
  if (!document) return reply(ticket, invalid_value(document.error()));
  const Result<scene::Scene> scene = prepare(*document);
  if (!scene) return reply(ticket, invalid_value(scene.error()));
  const Result<sim::ChangeDepth> depth = change(*scene);
  if (!depth) return reply(ticket, invalid_value(depth.error()));
  adopt(std::move(*document), *depth);
  reply(ticket, json{{"revision", revision_}, {"applies", sim::name(*depth)}});
  announce_scene(std::move(patch.patch), ticket.asker);
  if (*depth == sim::ChangeDepth::cloth)
    exchange_.emit(Notice{"info", "the cloth was rebuilt for this change: time starts again at 0"});
}

// If a change alters energies, the same state is diagnosed before and after: energy that the change adds does
// not count as growth, and growth does not go unnoticed between changes.
Result<sim::ChangeDepth> Stepper::change(const scene::Scene& scene) {
  if (!sim::changes_energy(this->scene(), scene)) return change_engine(scene);
  accept(guard_->judge_now());
  const Result<sim::ChangeDepth> depth = change_engine(scene);
  if (depth && *depth != sim::ChangeDepth::cloth) guard_->rebase();
  return depth;
}

/// Applies a changed scene. A scene that becomes heavy or light on software OpenGL moves to another engine;
/// the step that is under way is then given up.
Result<sim::ChangeDepth> Stepper::change_engine(const scene::Scene& scene) {
  const gl::HelperThreads threads = Engine::threads_for(scene, engine_->threads);
  return engine_->software() && threads != engine_->threads ? move_to(scene, threads)
                                                            : simulation().change(scene);
}

Result<sim::ChangeDepth> Stepper::move_to(const scene::Scene& scene, gl::HelperThreads threads) {
  struct Current {  // makes the context of `engine_` current, however this function ends
    std::unique_ptr<Engine>& engine;
    ~Current() { (void)engine->context->make_current(); }
  } current{engine_};
  const sim::ChangeDepth depth = sim::change_depth(simulation().scene(), scene);
  const bool anew = depth == sim::ChangeDepth::cloth;
  sim::State state;
  if (!anew) state = simulation().read_state();
  Result<std::unique_ptr<Engine>> made =
      Engine::create(scene, exchange_,
                     {gpu_, threads, frames().last(), simulation().topology_revision() + (anew ? 1u : 0u)});
  if (!made) return made.error();
  if (!anew) (*made)->simulation->restore(state, simulation().time(), simulation().step_index());
  (*made)->frames->take_over(frames());
  engine_.swap(*made);
  made->reset();
  guard_->move_to(simulation());
  if (!anew && !hands_.empty()) (void)simulation().set_hands(hands_.for_simulation());
  return depth;
}

void Stepper::adopt(scene::Document document, sim::ChangeDepth depth) {
  ++revision_;
  take_over(std::move(document), depth);
}

void Stepper::take_over(scene::Document document, sim::ChangeDepth depth) {
  document_ = std::move(document);
  wake_up();
  rest_.follow(scene(), simulation().model());
  if (depth == sim::ChangeDepth::cloth) {
    run_.go_on();  // like any other change: playing or paused as before a blow-up
    state_replaced();
  } else {
    frames().state_changed_now();
  }
  ++state_version_;
  announce_parts();
  announce_solver();
  if (depth == sim::ChangeDepth::none) return;
  warn_if_thin();
  step_limit_.set_scene(simulation().model(), scene());
  follow_step_limit();  // now, as another change may come before the next status
  if (depth == sim::ChangeDepth::cloth) return guard_->start(step_limit_.dt_limit());
  guard_->set_dt_limit(step_limit_.dt_limit());
  go_on();
}

void Stepper::restart() {
  simulation().reset();
  state_replaced();
  guard_->start(step_limit_.dt_limit());
}

void Stepper::state_replaced() {
  end_hands();
  finish_waiting(true);
  wake_up();
  run_.begin_again();
  slow_announced_ = crowded_announced_ = forced_announced_ = unconverged_announced_ = false;
  ++state_version_;
  real_time_.restart(Clock::now());
  frames().restart();
}

void Stepper::perform(Play&, const Ticket& ticket) {
  finish_waiting(true);
  wake_up();
  if (!run_.play()) return reply(ticket, diverged_refusal());
  ++state_version_;
  reply(ticket, where_we_are());
}

void Stepper::perform(Pause&, const Ticket& ticket) {
  finish_waiting(true);
  wake_up();
  ++state_version_;
  run_.pause();
  reply(ticket, where_we_are());
}

void Stepper::perform(Step& step, const Ticket& ticket) {
  wake_up();
  if (!run_.step_by_hand()) return reply(ticket, diverged_refusal());
  const std::uint64_t from = waiting_.empty() ? simulation().step_index() : waiting_.back().until_step;
  waiting_.push_back({ticket, from + step.steps});
}

void Stepper::perform(Reset&, const Ticket& ticket) {
  restart();
  record_change({{"reset", true}, {"by", ticket.asker}});
  reply(ticket, where_we_are());
}

void Stepper::perform(Speed& speed, const Ticket& ticket) {
  wake_up();
  ++state_version_;
  real_time_.set_speed(speed.factor);
  real_time_.restart(Clock::now());
  reply(ticket, json{{"factor", speed.factor}});
}

void Stepper::perform(Demand& demand, const Ticket&) {
  frames().demand(demand, Clock::now());
}

void Stepper::perform(Watchers& watchers, const Ticket&) {
  watchers_ = watchers.count;
  last_watched_ = Clock::now();
}

void Stepper::perform(ReachScene& reach, const Ticket&) {
  exchange_.emit(SceneReached{reach.job});
}

void Stepper::perform(Hold& hold, const Ticket&) {
  if (run_.hold()) {
    simulation().finish();  // otherwise work that is already queued would run beside the job
    exchange_.emit(Notice{"info", "paused while the lab measures"});
  }
  exchange_.emit(Held{hold.job});
}

void Stepper::perform(Release&, const Ticket&) {
  run_.release();
}

void Stepper::perform(Export& what, const Ticket& ticket) {
  last_watched_ = Clock::now();
  exchange_.emit(Captured{ticket.asker, what,
                          Moment{std::make_shared<const scene::Document>(document_), simulation().time(),
                                 simulation().read_state().position, simulation().colliders_now()}});
}

// The document keeps the method "auto"; sim.status shows the settings that are stepped with.
void Stepper::perform(Chosen& chosen, const Ticket&) {
  automatic_.take(*chosen.measured, chosen.choice);
  if (!document_.scene.solver.automatic) return;
  const Result<scene::Scene> scene = automatic_.settle(document_, Clock::now());
  if (!scene) return;
  const Result<sim::ChangeDepth> depth = change(*scene);
  if (!depth) return exchange_.emit(Notice{"warning", "method auto: " + depth.error().text()});
  take_over(document_, *depth);
  if (!chosen.choice)
    exchange_.emit(Notice{"warning", "method auto: nothing better than a stable step can be chosen: " +
                                         chosen.choice.error().text()});
  else
    exchange_.emit(Notice{"info", "method auto: " + chosen.choice->why});
}

void Stepper::announce_scene(std::optional<json> patch, std::uint64_t by) {
  // Clients need a topology before its frames, so it is sent together with the scene that changed it.
  if (const std::uint32_t revision = simulation().topology_revision(); revision != topology_revision_) {
    topology_revision_ = revision;
    exchange_.emit(TopologyChanged{stream::encode_topology(simulation().model(), revision)});
  }
  record_change({{patch ? "patch" : "document", patch ? *patch : document_.value}, {"by", by}});
  exchange_.emit(
      SceneChanged{std::make_shared<const scene::Document>(document_), revision_, std::move(patch), by});
}

void Stepper::announce_parts() {
  std::vector<sim::Simulation::Part> parts = simulation().parts();
  for (sim::Simulation::Part& part : parts)
    if (run_.at_rest() && part.skipped.empty()) part.skipped = "asleep: the cloth is at rest";
  exchange_.emit(PartsChanged{std::move(parts)});
}

// A stiffness in N/m means the same in every method except PBD. For PBD clients also get, for each kind of
// spring, the share of a spring's stretch that one visit removes.
void Stepper::announce_solver() {
  json shares = nullptr;
  if (scene().solver.method == scene::Method::pbd) {
    shares = json::array();
    for (const model::PbdStiffness& of : model::pbd_stiffness(simulation().model(), scene())) {
      const auto share = [&](model::SpringKind kind) {
        const std::optional<double>& value = of[static_cast<std::size_t>(kind)];
        return value ? json(*value) : json(nullptr);
      };
      shares.push_back({{"structural", share(model::SpringKind::structural)},
                        {"shear", share(model::SpringKind::shear)},
                        {"bend", share(model::SpringKind::bend)}});
    }
  }
  json thickness = nullptr;
  if (scene().collides(scene::ContactKind::points))
    thickness = model::least_safe_thickness(simulation().model());
  exchange_.emit(SolverChanged{{{"pbd_stiffness", shares},
                                {"auto", automatic_.facts()},
                                {"thickness_that_holds", thickness},
                                {"from_fabrics", scene::left_to_fabrics(document_)}}});
}

// Warns once, after a change of scene that lets layers of cloth pass through each other.
void Stepper::warn_if_thin() {
  const std::string warning = model::thickness_warning(simulation().model(), scene());
  if (!std::exchange(layers_may_pass_, !warning.empty()) && layers_may_pass_)
    exchange_.emit(Notice{"warning", warning});
}

}  // namespace clothlab::session
