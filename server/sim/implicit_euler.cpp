// Implicit Euler and BDF2 on the GPU: the Newton steps of a time step, how far each is taken, and when they
// end. implicit_passes.h has what is done before and after a solve, conjugate_gradients.h the solver, bdf2.h
// what BDF2 keeps of its last steps.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "server/sim/contact_term.h"
#include "server/sim/implicit_passes.h"
#include "server/sim/solved.h"
#include "server/sim/surface_contact.h"

namespace clothlab::sim {

namespace {

/// Newton steps of a time step with contact, at most: crushed layers take that many. Where contact presses
/// they go on until one moves no vertex farther than this share of a cloth's mean edge.
constexpr int most_contact_steps = 40;
constexpr double step_solved_share = 0.05;
/// The last one is to be taken but for less than this share of what gravity lets fall in a step: what is not
/// taken is lost for the velocity. Where nothing is near, one that moves no vertex farther is the last, too.
constexpr double untaken_share = 0.02;
/// And until the friction of all pairs together is off by no more than this share of it.
constexpr double slips_share = 0.03;
/// `solve` goes on with contact until this share of those ways is left.
constexpr double exact_share = 0.1;
/// How often a solve with contact may start again after its residual has lost its precision to rounding.
constexpr int most_restarts = 4;

/// Of all vertices that are not pinned [kg].
double free_mass(const model::Model& model) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] == model::not_pinned) sum += model.mass[i];
  return sum;
}

class ImplicitEuler : public ImplicitPasses {
 public:
  static Result<std::unique_ptr<Integrator>> create(const model::Model& model, const Plan& plan) {
    std::unique_ptr<ImplicitEuler> made(new ImplicitEuler(model, plan));
    if (const Status loaded = made->load(model, plan); !loaded) return loaded.error();
    return std::unique_ptr<Integrator>(std::move(made));
  }

  void set_parameters(const Surroundings& around) override {
    ImplicitPasses::set_parameters(around);
    most_newton_steps_ = around.scene.solver.iterations;
    solved_way_ = step_solved_share * SurfacePairs::finest_edge(around.model);
    untaken_way_ = std::min(0.1 * solved_way_, untaken_share * gravity_at_least * dt_ * dt_);
    allowed_ = allowed_error(around.model, scene::Method::implicit_euler, dt_);
    free_mass_ = free_mass(around.model);
    set_tolerance(around.scene.solver.tolerance);
  }

  Work step(StateBuffers& state, int row) override {
    if (bdf2_)
      co_await step_by_bdf2(state, row);
    else
      co_await solve_step(state, row);
    state.swap();
  }

  /// Writes the state at the step's end to the other copy.
  Work solve_step(StateBuffers& state, int row) {
    if (contact_) take_bodies(state, row);
    begin(state, row);
    taken_whole_ = true;
    bool moved = true;  // from the step's start
    if (contact_)
      moved = begin_between_surfaces(state, row);
    else
      begin_with_velocity();
    Solved solved;
    // With contact a solve may leave this share of the change to the next Newton step, whose pairs are
    // others: more exactness would be lost (inexact Newton: Dembo, Eisenstat & Steihaug 1982). A Newton step
    // squares the error, so it is the root of what the tolerance asks for in the end.
    ConjugateGradients::Enough enough{.left_share = contact_ ? std::sqrt(tolerance_) : 0.0};
    int most = most_newton_steps_;
    for (int newton = 0; newton < most; ++newton) {
      if (contact_ && moved) find_contact(state, false);
      set_up(newton == 0, !moved);
      if (newton == 0) improve_guess();
      if (newton > 0 && !contact_) enough.little = little();
      if (newton == 0 || contact_)
        solver_.prepare(
            {position_, constraint_, contact_ ? contact_->term()->read() : std::vector<PressingPair>()},
            touches_);
      co_await solver_.solve(guess_, enough, solved);
      for (int again = 0; contact_ && again < most_restarts && solved.lost_precision; ++again) {
        // The residual is computed anew, of what is solved so far.
        work_.linear_iterations += solved.iterations;
        dispatches_ += solved.dispatches;
        guess_.buffer.copy_from(solved.change->buffer);
        set_up(false, false);
        co_await solver_.solve(guess_, enough, solved);
      }
      dispatches_ += solved.dispatches;
      ++work_.newton_steps;
      work_.linear_iterations += solved.iterations;
      work_.unconverged += solved.converged ? 0 : 1;
      const bool met = newton > 0 && solved.iterations == 0;  // the estimate already meets the tolerance
      if (met && !contact_) break;
      if (contact_) {
        const ContactTerm::Limit limit = limit_by_contact(state, *solved.change);
        search(*solved.change);
        most = choose(limit, newton, met, most);
      } else {
        solved.residual->bind(unit_residual);
        search(*solved.change);
      }
      advance(row, newton + 1 < most);
      if (contact_) contact_->term()->take(position_);
      moved = true;
      co_await may_stop;
    }
    if (contact_) contact_->end_solve(position_);
    if (contacts_.id()) keep_apart();
    finish(state, *solved.residual, row);
  }

  /// By the formula where the motion is smooth, else by implicit Euler. Where it shows that it is not in a
  /// step by the formula, which would give back a part of what contact stops, the step is done again.
  Work step_by_bdf2(StateBuffers& state, int row) {
    bdf2_->begin(held_);
    if (bdf2_->by_formula()) bdf2_->put_aside({&contact_friction_, &past_velocities_});
    for (bool again = true; again;) {
      set_equation_time();
      co_await solve_step(state, row);
      if (contact_) contact_->term()->bind();
      const bool smooth = !bdf2_->look(state, wind_loads_, row) && taken_whole_;
      again = !smooth && bdf2_->begin_by_implicit_euler();
      if (again)
        bdf2_->put_back({&contact_friction_, &past_velocities_});
      else
        bdf2_->accept(smooth);
    }
  }

  int iterations() const override { return most_newton_steps_; }

  Work again(StateBuffers& state, int row) override {
    const Uncounted uncounted(*this);
    co_await step(state, row);
  }

  Work solve(StateBuffers& state, int row, const Precision& precision, SolverWork& spent) override {
    const Uncounted uncounted(*this);
    most_newton_steps_ = precision.newton_steps;
    set_tolerance(precision.tolerance);
    solved_way_ *= exact_share;
    untaken_way_ *= exact_share;
    allowed_ *= exact_share;
    work_ = {};
    co_await step(state, row);
    spent = work_;
  }

  SolverWork work() const override { return work_; }

 private:
  using ImplicitPasses::ImplicitPasses;

  /// While it lives, no work is counted, and a step may be solved further; it may end half-way.
  class Uncounted {
   public:
    explicit Uncounted(ImplicitEuler& of)
        : of_(of),
          dispatches_(of.dispatches_),
          work_(of.work_),
          most_newton_steps_(of.most_newton_steps_),
          tolerance_(of.tolerance_),
          solved_way_(of.solved_way_),
          untaken_way_(of.untaken_way_),
          allowed_(of.allowed_) {}
    ~Uncounted() {
      of_.dispatches_ = dispatches_;
      of_.work_ = work_;
      of_.most_newton_steps_ = most_newton_steps_;
      of_.set_tolerance(tolerance_);
      of_.solved_way_ = solved_way_;
      of_.untaken_way_ = untaken_way_;
      of_.allowed_ = allowed_;
    }
    Uncounted(const Uncounted&) = delete;

   private:
    ImplicitEuler& of_;
    std::uint64_t dispatches_;
    SolverWork work_;
    int most_newton_steps_;
    double tolerance_, solved_way_, untaken_way_, allowed_;
  };

  /// The energy [J] of the speed at which the whole cloth would go as far in a step as may be left, twice.
  /// That of a Newton step, by its own matrix, is no less than its kinetic energy.
  double little() const {
    const double speed = allowed_ / dt_;
    return free_mass_ * speed * speed;
  }

  void set_tolerance(double tolerance) {
    tolerance_ = tolerance;
    system_.set("tolerance", static_cast<float>(tolerance));
  }

  /// Goes the share of the way of the start's velocity that contact allows and a line search finds best.
  /// Returns whether that is more than nothing; if not, the pairs that press are known.
  bool begin_between_surfaces(const StateBuffers& state, int row) {
    find_contact(state, true);
    if (limit_by_contact(state, first_change_).longest <= solved_way_) return false;
    search(first_change_);
    const bool moves = choose_share() > 0.0f;
    advance_.set("solved", 0);
    advance(row, true);
    advance_.set("solved", 1);
    contact_->term()->take(position_);
    return moves;
  }

  /// Makes the estimates as long as the state, whose bodies they have, too.
  void take_bodies(const StateBuffers& state, int row) {
    const std::size_t bytes = state.position().buffer.bytes();
    for (gl::TextureBuffer* places : {&start_position_, &position_}) {
      if (places->buffer.bytes() != bytes) *places = {gl::Buffer(bytes), GL_RGBA32F};
      places->buffer.copy_from(state.position().buffer);
    }
    contact_->begin_solve(state, row);
  }

  /// Finds the pairs of surfaces that press at the present estimate.
  void find_contact(const StateBuffers& state, bool first) {
    pressing_ = contact_->find_pressing(position_, first);
    bind_inputs(state);
    contact_->term()->bind();
  }

  /// Finds how much of a solved change can be taken before surfaces would meet.
  ContactTerm::Limit limit_by_contact(const StateBuffers& state, const gl::TextureBuffer& change) {
    const ContactTerm::Limit limit = contact_->limit(position_, change);
    bind_inputs(state);
    position_.bind(unit_position);
    velocity_.bind(unit_velocity);
    contact_->term()->bind();
    contact_->term()->bind_shares();
    contact_->term()->set_solids(search_);
    return limit;
  }

  /// Chooses the share of a change that is taken, by what contact allows and the line search found.
  float choose_share() {
    choose_.use();
    dispatch(1);
    wait_for_writes();
    return contact_->term()->take_share();
  }

  /// Chooses the share of a solved change that is taken. Returns how many Newton steps the time step has now.
  /// `met`: the solve has found nothing left.
  int choose(const ContactTerm::Limit& limit, int newton, bool met, int most) {
    const double left = 1.0 - static_cast<double>(choose_share());
    if (!limit.known) {
      taken_whole_ = false;
      return newton + 1;
    }
    const double longest = limit.longest;
    if (pressing_ == 0 && limit.reachable == 0) return met || longest <= untaken_way_ ? newton + 1 : most;
    const bool whole = left * longest <= untaken_way_;
    const bool still =
        limit.pressed <= solved_way_ && (longest <= solved_way_ || newton + 1 >= most_newton_steps_);
    const bool rubs = limit.slips <= slips_share;
    if (whole && rubs && (met || still)) return newton + 1;
    const int most_of_all = std::max(most_newton_steps_, most_contact_steps);
    if (newton + 1 == most_of_all) {  // and what is left of the step is not taken
      ++work_.unconverged;
      taken_whole_ = false;
    }
    return most_of_all;
  }

  bool taken_whole_ = true;  ///< the step under way, but for what contact has kept it from
  int most_newton_steps_ = 1;
  double tolerance_ = 0;        ///< of a linear solve: relative, of the residual
  double untaken_way_ = 0;      ///< the most that a last Newton step may not take [m]
  double solved_way_ = 0;       ///< a Newton step that moves no vertex farther has solved the problem [m]
  double allowed_ = 0;          ///< without contact Newton steps end where one would go less far [m]
  double free_mass_ = 0;        ///< of all that is not pinned [kg]
  std::uint32_t pressing_ = 0;  ///< pairs of surfaces that press at the present estimate
  SolverWork work_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_implicit_euler(const model::Model& model, const Plan& plan) {
  return ImplicitEuler::create(model, plan);
}

}  // namespace clothlab::sim
