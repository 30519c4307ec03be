// What a session warns its viewers of, each once until the scene or the cloth is another.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/base/text.h"
#include "server/model/dress.h"
#include "server/model/near_start.h"
#include "server/model/thickness.h"
#include "server/scene/method.h"
#include "server/session/stepper.h"
#include "server/sim/convergence.h"
#include "server/sim/plan.h"
#include "server/sim/slipping.h"

namespace clothlab::session {

using std::chrono::seconds;

void Stepper::warn_if_slow(Clock::time_point now) {
  if (!was_running_ || !real_time_.sampled() || real_time_.factor() > 0.9 * real_time_.speed()) {
    slow_since_ = now;
    return;
  }
  if (slow_announced_ || now - slow_since_ < seconds(3)) return;
  slow_announced_ = true;
  std::string text = "this machine cannot keep up: ";
  text += real_time_.step_cost() >= 0.1 ? formatted("a step takes %.2g s", real_time_.step_cost())
                                        : std::string("time runs slower than asked for");
  text += "; a smaller cloth, ";
  if (scene::iterates(scene().solver.method)) text += "fewer iterations, ";
  if (const double others = simulation().search_candidates(); others >= 500)
    text += formatted("a smaller self_collision thickness (each vertex is compared with about %.0f others), ",
                      others);
  exchange_.emit(Notice{"warning", text + "a longer time step or a lower speed helps", false, "pace"});
}

void Stepper::warn_if_crowded() {
  if (crowded_announced_ || guard_->state().neighbours_dropped == 0) return;
  crowded_announced_ = true;
  exchange_.emit(Notice{"warning",
                        "self-collision: some vertices have more neighbours than there is room for, and the "
                        "farthest are left out; "
                        "a smaller thickness or a coarser mesh helps"});
}

void Stepper::warn_if_lists_stay() {
  const std::string why = list_memory_->take_refusal();
  if (why.empty() || std::exchange(lists_stay_announced_, true)) return;
  exchange_.emit(Notice{"warning",
                        "contact has found more pairs than its lists have room for, and they cannot "
                        "be longer (" +
                            why +
                            "): cloth moves more slowly where it is near itself, or stands still; a "
                            "coarser mesh or a smaller thickness helps, or a larger --max-memory"});
}

void Stepper::warn_if_not_taken() {
  if (not_taken_announced_ || guard_->state().surface_not_taken == 0) return;
  not_taken_announced_ = true;
  exchange_.emit(Notice{
      "warning",
      "a step was not taken, as more pairs of triangles and edges could meet in it than any list has room "
      "for: cloth stands still then; a coarser mesh, a smaller dt or a slower motion helps"});
}

void Stepper::warn_if_forced() {
  if (forced_announced_ || guard_->state().surface_forced <= guard_->state().surface_not_taken) return;
  forced_announced_ = true;
  // A start that is too near has been told, and is the cause if nothing moves by itself.
  if (!near_start_.empty() && sim::moving_motions(scene()).empty()) return;
  exchange_.emit(
      Notice{"warning",
             "pins or bodies that move press cloth where it cannot go: a pin waits until there is room, "
             "and a body may pass through what is in its way; slower or smaller motions help"});
}

// A few steps that do not converge need no warning: they occur when a cloth falls into its strain limit.
void Stepper::warn_if_unconverged() {
  constexpr std::uint64_t many = 50;
  const bool limit = simulation().strain_limit_work().unconverged > many;
  const bool solver = simulation().solver_work().unconverged > many;
  if (unconverged_announced_ || !(limit || solver)) return;
  unconverged_announced_ = true;
  exchange_.emit(Notice{
      "warning", limit ? "strain_limit: some springs or threads stay longer than it allows; a larger limit, "
                         "a shorter time step or pins that leave room helps"
                       : "linear solves often end before they meet solver.tolerance, or steps before "
                         "contact is solved; a shorter time step or a larger tolerance helps"});
}

void Stepper::warn_if_unsolved() {
  const sim::Convergence& convergence = simulation().convergence();
  if (unsolved_announced_ || !convergence.often_unsolved()) return;
  unsolved_announced_ = true;
  exchange_.emit(Notice{"warning", sim::in_words(convergence, scene())});
}

// Warns once, after a change of scene that lets layers of cloth pass through each other.
void Stepper::warn_if_thin() {
  const std::string warning = model::thickness_warning(simulation().model(), scene());
  if (!std::exchange(layers_may_pass_, !warning.empty()) && layers_may_pass_)
    exchange_.emit(Notice{"warning", warning});
}

// Warns once, after a change of scene that lets a solid pass through triangles of cloth.
void Stepper::warn_if_slipping() {
  const std::string warning = sim::slipping_warning(scene(), simulation().model());
  if (!std::exchange(solids_may_slip_, !warning.empty()) && solids_may_slip_)
    exchange_.emit(Notice{"warning", warning});
}

// Warns once of a start, which another cloth has, that leaves contact no room.
void Stepper::warn_if_near() {
  std::string warning = model::near_start_warning(simulation().model(), scene());
  if (!warning.empty() && warning != near_start_) exchange_.emit(Notice{"warning", warning});
  near_start_ = std::move(warning);
}

// Tells once what was done to a start that was led out.
void Stepper::tell_if_led_out() {
  std::string note = model::dressed_note(simulation().model());
  if (!note.empty() && note != led_out_) exchange_.emit(Notice{"info", note});
  led_out_ = std::move(note);
}

// Tells each note of the scene's meshes once, until the scene no longer has it.
void Stepper::warn_of_meshes() {
  std::vector<std::string> notes = scene::mesh_notes(scene());
  for (const std::string& note : notes)
    if (std::find(mesh_notes_.begin(), mesh_notes_.end(), note) == mesh_notes_.end())
      exchange_.emit(Notice{"warning", note});
  mesh_notes_ = std::move(notes);
}

}  // namespace clothlab::session
