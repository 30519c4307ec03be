// The commands that change the scene, or undo and redo its changes; and how a new scene takes the old one's
// place.
#include <algorithm>
#include <utility>

#include "server/model/remedy.h"
#include "server/scene/method.h"
#include "server/scene/vertex_numbers.h"
#include "server/session/change_name.h"
#include "server/session/stepper.h"
#include "server/sim/cost.h"

namespace clothlab::session {

namespace {

/// True if a patch puts another document in the place of all: that its cloth is new is what was asked for.
bool replaces_all(const json& patch) {
  return patch.is_array() && std::any_of(patch.begin(), patch.end(), [](const json& operation) {
           return operation.value("op", "") == "replace" && operation.value("path", "/") == "";
         });
}

}  // namespace

void Stepper::perform(GetScene&, const Ticket& ticket) {
  reply(ticket, scene_text());
}

void Stepper::perform(LoadScene& load, const Ticket& ticket) {
  Result<scene::Document> document = load.preset.empty() ? scene::validate(std::move(load.document), meshes_)
                                                         : scene::load_preset(load.preset, meshes_);
  if (!document && !load.preset.empty())
    return reply(ticket, invalid_value({"/preset", json(load.preset).dump(), document.error().remedy}));
  if (!document) return reply(ticket, invalid_value(document.error()));
  if (const clothlab::Status fits = scene::check_bytes(document->value); !fits)
    return reply(ticket, invalid_value(fits.error()));
  History::Change made = history_.prepare(document_.value, document->value,
                                          shortened("Load " + document->scene.name, max_change_name_bytes),
                                          ticket.asker, Clock::now());
  made.loaded = true;
  under_way_.name = made.name;
  made.values_only = false;
  if (const Result<sim::ChangeDepth> depth = bring(std::move(*document), true); !depth)
    return reply(ticket, refused(depth.error()));
  reply(ticket, json{{"revision", revision_}, {"applies", sim::name(sim::ChangeDepth::cloth)}});
  announce_scene(std::nullopt, ticket.asker);
  remember(std::move(made));
}

/// True if the request was made for another revision; it is refused then.
bool Stepper::outdated(std::optional<std::uint64_t> revision, const Ticket& ticket) {
  if (!revision || *revision == revision_) return false;
  reply(
      ticket,
      Refusal{
          Refusal::Reason::other_revision,
          {"", "the scene is at revision " + std::to_string(revision_) + ", not " + std::to_string(*revision),
           "get the scene and patch that"},
          revision_});
  return true;
}

void Stepper::perform(PatchScene& patch, const Ticket& ticket) {
  if (outdated(patch.revision, ticket)) return;
  Result<scene::Document> document = scene::apply_patch(document_, patch.patch);
  if (!document) return reply(ticket, invalid_value(document.error()));
  under_way_.name = patch.name;
  json answer = json::object();
  if (patch.keep_stable) {
    const auto solver = built([&] { return keep_stable(patch.patch, *document); });
    if (!solver) return reply(ticket, refused(solver.error()));
    if (*solver) answer["solver"] = **solver;
  }
  if (const clothlab::Status fits = scene::check_bytes(document->value); !fits)
    return reply(ticket, invalid_value(fits.error()));
  History::Change made =
      history_.prepare(document_.value, document->value, std::move(patch.name), ticket.asker, Clock::now());
  under_way_.name = made.name;
  const Result<sim::ChangeDepth> depth = bring(std::move(*document), false);
  if (!depth) return reply(ticket, refused(depth.error()));
  answer.update({{"revision", revision_}, {"applies", sim::name(*depth)}});
  reply(ticket, std::move(answer));
  const bool another = replaces_all(patch.patch);
  announce_scene(std::move(patch.patch), ticket.asker);
  remember(std::move(made));
  if (!another) tell_if_rebuilt(*depth);
}

/// If the cloth of `document`, which `patch` has made, would not hold with its solver, changes the solver of
/// both, and returns it. A method that the patch has chosen stays.
Result<std::optional<json>> Stepper::keep_stable(json& patch, scene::Document& document) const {
  if (const clothlab::Status fits = check_size(document); !fits) return fits.error();
  const Result<model::Model> model = model::build(document.scene);
  if (!model) return model.error();
  const bool chosen = document.scene.solver.method != document_.scene.solver.method;
  const scene::Solver solver = chosen ? model::step_that_holds(*model, document.scene)
                                      : model::solver_that_holds(*model, document.scene);
  if (solver == document.scene.solver) return std::optional<json>();
  json change{{"method", scene::name(solver.method)},
              {"dt", solver.dt},
              {"iterations", solver.iterations},
              {"tolerance", solver.tolerance}};
  Result<scene::Document> held = scene::apply_patch(document, {{"solver", change}});
  if (!held) return held.error();
  document = std::move(*held);
  if (patch.is_array())
    for (const auto& [key, value] : change.items())
      patch.push_back({{"op", "replace"}, {"path", "/solver/" + key}, {"value", value}});
  else
    patch["solver"] = change;
  return std::optional(std::move(change));
}

void Stepper::tell_if_rebuilt(sim::ChangeDepth depth) {
  if (depth == sim::ChangeDepth::cloth)
    exchange_.emit(Notice{"info", "the cloth was rebuilt for this change: time starts again at 0"});
}

/// A change that cannot be taken back, as its mesh is gone, stays the next one to undo: nothing is lost.
void Stepper::perform(TravelHistory& travel, const Ticket& ticket) {
  if (undone_while_built_ && undone_while_built_->first.asker == ticket.asker &&
      undone_while_built_->first.id == ticket.id) {
    reply(ticket, json{{"revision", revision_},
                       {"name", undone_while_built_->second},
                       {"applies", sim::name(sim::ChangeDepth::none)}});
    return undone_while_built_.reset();
  }
  if (outdated(travel.revision, ticket)) return;
  const bool undo = travel.direction == Direction::undo;
  const History::Change* change = history_.next(travel.direction);
  if (!change)
    return reply(ticket, Refusal{Refusal::Reason::nothing_there,
                                 {"", undo ? "there is nothing to undo" : "there is nothing to redo",
                                  undo ? "change the scene first; the last " + std::to_string(max_changes) +
                                             " changes are kept"
                                       : "only what was undone can be redone, until the next change"}});
  const std::string name = under_way_.name = change->name;
  const std::string& way = undo ? change->back : change->forth;
  std::optional<json> patch;
  if (json step = json::parse(way, nullptr, false); step.is_array() && !change->mesh) patch = std::move(step);
  const Result<sim::ChangeDepth> depth = travelled(*change, travel.direction);
  if (!depth) {
    Error why = depth.error();
    why.what = (undo ? "cannot undo " : "cannot redo ") + name + ": " + why.what;
    return reply(ticket, refused(std::move(why)));
  }
  history_.moved(travel.direction, ticket.asker);
  reply(ticket, json{{"revision", revision_}, {"name", name}, {"applies", sim::name(*depth)}});
  announce_scene(std::move(patch), ticket.asker);
  announce_history();
  tell_if_rebuilt(*depth);
}

Result<sim::ChangeDepth> Stepper::travelled(const History::Change& change, Direction direction) {
  const bool undo = direction == Direction::undo;
  std::optional<MeshShelf::SharedItem> present;  // to put back if the scene is refused
  if (change.mesh) {
    const MeshShelf::SharedItem& wanted = undo ? change.mesh->before : change.mesh->after;
    if (wanted)
      if (const auto place = meshes_->make_place(change.mesh->name, wanted->bytes.size(), meshes_named());
          !place)
        return place.error();
    present = meshes_->exchange(change.mesh->name, wanted);
  }
  Result<json> value = history_.target(direction, document_.value);
  Result<scene::Document> document = value ? scene::validate(std::move(*value), meshes_) : value.error();
  Result<sim::ChangeDepth> depth = document ? bring(std::move(*document), change.loaded) : document.error();
  if (!depth && present) meshes_->exchange(change.mesh->name, *present);
  if (depth && change.mesh) keep_mesh(change.mesh->name);
  return depth;
}

/// Puts a valid document in the place of the present one. `anew`: the cloth starts at its beginning, however
/// little the documents differ. On error nothing has changed.
Result<sim::ChangeDepth> Stepper::bring(scene::Document document, bool anew) {
  const Result<sim::ChangeDepth> depth = built([&] { return engine_for(document, anew); });
  if (!depth) return depth.error();
  if (anew) run_.go_on();  // after a blow-up the new scene plays or is paused as the old one was before
  adopt(std::move(document), *depth);
  if (anew && *depth != sim::ChangeDepth::cloth) restart();
  return anew ? sim::ChangeDepth::cloth : *depth;
}

Result<sim::ChangeDepth> Stepper::engine_for(const scene::Document& document, bool anew) {
  const Result<scene::Scene> scene = prepare(document);
  if (!scene) return scene.error();
  return anew ? change_engine(*scene) : change(*scene);
}

Refusal Stepper::refused(Error error) const {
  return {under_way_.given_up ? Refusal::Reason::given_up : Refusal::Reason::invalid_value, std::move(error)};
}

void Stepper::remember(History::Change change) {
  history_.add(std::move(change));
  announce_history();
}

/// Tells what can be undone and redone, if it is no longer what was told last.
void Stepper::announce_history() {
  json told = history_.told();
  if (told == history_told_) return;
  history_told_ = told;
  exchange_.emit(HistoryChanged{std::move(told)});
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

/// Applies a changed scene. A scene that becomes small or large on software OpenGL moves to another engine;
/// the step that is under way is then given up.
Result<sim::ChangeDepth> Stepper::change_engine(const scene::Scene& scene) {
  compiled_ = false;
  if (returns_to_left_engine(scene)) {
    const sim::ChangeDepth depth = sim::change_depth(simulation().scene(), scene);
    (void)left_->context->make_current();
    settle_in(std::move(left_));
    begin_timeline();
    return depth;
  }
  if (!engine_->place || engine_->place->stays(sim::expected_share(scene))) return change_here(scene);
  const Result<sim::ChangeDepth> depth = move_to(scene);
  if (depth && *depth != sim::ChangeDepth::cloth) begin_timeline();  // its states were on the other engine
  return depth;
}

/// While what is new is built, what is old stays: both need memory.
Result<sim::ChangeDepth> Stepper::change_here(const scene::Scene& scene) {
  const sim::ChangeDepth depth = sim::change_depth(simulation().scene(), scene);
  if (depth == sim::ChangeDepth::none || depth == sim::ChangeDepth::uniform)
    return simulation().change(scene);
  Result<MemoryBudget::Reservation> place = place_for(scene);
  if (!place && left_) {
    free_left_engine();
    place = place_for(scene);
  }
  if (!place) return place.error();
  const Result<sim::ChangeDepth> done = simulation().change(scene);
  if (done) engine_->memory = std::move(*place);
  return done;
}

Result<sim::ChangeDepth> Stepper::move_to(const scene::Scene& scene) {
  struct Current {  // makes the context of `engine_` current, however this function ends
    std::unique_ptr<Engine>& engine;
    ~Current() { (void)engine->context->make_current(); }
  } current{engine_};
  const sim::ChangeDepth depth = sim::change_depth(simulation().scene(), scene);
  const bool anew = depth == sim::ChangeDepth::cloth;
  sim::State state;
  if (!anew) state = simulation().read_state();
  free_left_engine();
  Result<MemoryBudget::Reservation> place = place_for(scene);
  if (!place) return place.error();
  Result<std::unique_ptr<Engine>> made = Engine::create(
      scene, exchange_, {gpu_, frames().last(), simulation().topology_revision() + (anew ? 1u : 0u)});
  if (!made) return made.error();
  const Whole whole;
  (*made)->memory = std::move(*place);
  if (!anew) (*made)->simulation->restore(state, simulation().time(), simulation().step_index());
  settle_in(std::move(*made));
  if (anew) free_left_engine();
  return depth;
}

/// Whether a change ends where the last ones began, on another engine, with no step between: what methods
/// remember is still there.
bool Stepper::returns_to_left_engine(const scene::Scene& scene) const {
  return left_ && left_->simulation->step_index() == simulation().step_index() &&
         sim::change_depth(left_->simulation->scene(), scene) == sim::ChangeDepth::none;
}

/// `next`, whose context is current, becomes the engine. The one before is kept until the next step.
void Stepper::settle_in(std::unique_ptr<Engine> next) {
  next->frames->take_over(frames());
  left_ = std::exchange(engine_, std::move(next));
  guard_->move_to(simulation());
  if (!hands_.empty()) (void)simulation().set_hands(hands_.for_simulation());
}

void Stepper::free_left_engine() {
  if (!left_) return;
  left_.reset();
  (void)engine_->context->make_current();
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
    scene_on_timeline();
    frames().state_changed_now();
  }
  ++state_version_;
  announce_parts();
  announce_solver();
  if (depth == sim::ChangeDepth::none) return;
  if (depth == sim::ChangeDepth::cloth) {
    warn_if_near();
    tell_if_led_out();
  }
  warn_if_thin();
  warn_if_slipping();
  warn_of_meshes();
  step_limit_.set_scene(simulation().model(), scene());
  judge_scene();
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
  free_left_engine();
  end_hands();
  finish_waiting(true);
  wake_up();
  run_.begin_again();
  lists_stay_announced_ = false;
  slow_announced_ = crowded_announced_ = forced_announced_ = not_taken_announced_ = unconverged_announced_ =
      unsolved_announced_ = false;
  ++state_version_;
  real_time_.restart(Clock::now());
  frames().restart();
  begin_timeline();
}

void Stepper::announce_scene(std::optional<json> patch, std::uint64_t by) {
  // Clients need a topology before its frames, so it is sent together with the scene that changed it.
  if (const std::uint32_t revision = simulation().topology_revision(); revision != topology_revision_) {
    topology_revision_ = revision;
    std::vector<std::uint32_t> renumbered;
    for (std::uint32_t cloth = 0; cloth < scene().cloths.size(); ++cloth)
      if (scene::renumbered(scene().cloths[cloth].mesh)) renumbered.push_back(cloth);
    exchange_.emit(
        TopologyChanged{stream::encode_topology(simulation().model(), revision), std::move(renumbered)});
  }
  record_change({{patch ? "patch" : "document", patch ? *patch : document_.value}, {"by", by}});
  exchange_.emit(SceneChanged{std::make_shared<const scene::Document>(document_), scene_text(), revision_,
                              std::move(patch), by});
}

/// The document and its revision as text, made once for each revision.
const JsonText& Stepper::scene_text() {
  if (!scene_text_ || scene_text_revision_ != revision_) {
    scene_text_ = text_of({{"document", document_.value}, {"revision", revision_}});
    scene_text_revision_ = revision_;
  }
  return scene_text_;
}

}  // namespace clothlab::session
