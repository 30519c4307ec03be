// Implicit Euler on the GPU: shaders/methods/implicit_*.comp. This file has the passes of a step before and
// after the solves, conjugate_gradients.h the solver. BDF2 has the same passes, and bdf2.h.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "server/sim/bdf2.h"
#include "server/sim/conjugate_gradients.h"
#include "server/sim/integrator.h"
#include "server/sim/surface_contact.h"

namespace clothlab::sim {

namespace {

/// Passes of self-collision after the solve. Each pass leaves half of the speed at which two vertices
/// approach each other, or less.
constexpr int contact_passes = 4;
/// Newton steps of a time step with contact, at most: crushed layers take that many. Where contact presses
/// they go on until one moves no vertex farther than this share of a cloth's mean edge.
constexpr int most_contact_steps = 40;
constexpr double solved_share = 0.05;
/// The last one is to be taken but for less than this share of what gravity lets fall in a step: what is not
/// taken is lost for the velocity. Where nothing is near, one that moves no vertex farther is the last, too.
constexpr double untaken_share = 0.02, gravity_at_least = 9.81;
/// And until the friction of all pairs together is off by no more than this share of it.
constexpr double slips_share = 0.03;
/// `solve` goes on with contact until this share of those ways is left.
constexpr double exact_share = 0.1;
/// Of a solve with contact whose residual has lost its precision to rounding.
constexpr int most_restarts = 4;
constexpr std::uint32_t trends = 3;  ///< TRENDS in implicit_euler.glsl

class ImplicitEuler : public Integrator {
 public:
  static Result<std::unique_ptr<Integrator>> create(const model::Model& model, const Plan& plan) {
    std::unique_ptr<ImplicitEuler> made(new ImplicitEuler(model, plan));
    gl::Defines defines = step_defines(plan);
    for (gl::Defines::value_type& define : made->solver_.defines()) defines.push_back(std::move(define));
    if (plan.contact_term()) defines.emplace_back("CONTACT_TERM", "1");
    if (plan.method == scene::Method::bdf2) {
      defines.emplace_back("BDF2", "1");
      Result<Bdf2> bdf2 = Bdf2::create(model, plan, defines);
      if (!bdf2) return bdf2.error();
      made->bdf2_ = std::move(*bdf2);
    }
    if (!plan.pins && plan.solid_count() == 0 && plan.bodies == 0) defines.emplace_back("FREE", "1");
    for (auto [program, name] : {std::pair{&made->start_, "start"},
                                 {&made->system_, "system"},
                                 {&made->project_, "project"},
                                 {&made->improve_, "improve"},
                                 {&made->search_, "search"},
                                 {&made->advance_, "advance"},
                                 {&made->end_, "end"}}) {
      Result<gl::Program> loaded =
          gl::Program::load({std::string("methods/implicit_") + name + ".comp"}, defines);
      if (!loaded) return loaded.error();
      *program = std::move(*loaded);
      made->solver_.set_layout(*program);
    }
    if (plan.contact_term()) made->advance_.set("solved", 1);
    if (const Status loaded = made->solver_.load(defines); !loaded) return loaded.error();
    gl::Program& either = plan.contact_term() ? made->choose_ : made->first_;
    Result<gl::Program> loaded = gl::Program::load(
        {std::string("methods/implicit_") + (plan.contact_term() ? "choose" : "first") + ".comp"}, defines);
    if (!loaded) return loaded.error();
    either = std::move(*loaded);
    made->solver_.set_layout(either);
    if (plan.self_collision) {
      Result<gl::Program> loaded = gl::Program::load({"methods/implicit_contacts.comp"}, defines);
      if (!loaded) return loaded.error();
      made->contacts_ = std::move(*loaded);
    }
    if (plan.wind) {
      Result<gl::Program> loaded = gl::Program::load({"methods/implicit_wind.comp"}, defines);
      if (!loaded) return loaded.error();
      made->wind_ = std::move(*loaded);
      made->wind_loads_ = {gl::Buffer(std::size_t{model.vertex_count()} * 4 * sizeof(float)), GL_RGBA32F};
      if (made->bdf2_)
        for (gl::TextureBuffer* vector : {&made->expected_position_, &made->expected_velocity_})
          *vector = {gl::Buffer(made->wind_loads_.buffer.bytes()), GL_RGBA32F};
    }
    return std::unique_ptr<Integrator>(std::move(made));
  }

  void set_parameters(const Surroundings& around) override {
    for (const gl::Program* program : programs()) {
      set_step_uniforms(*program, around);
      program->set("step_length", static_cast<float>(around.scene.solver.dt));
    }
    if (around.scene.solver.dt != dt_) restart();  // impulses kept in `contact_friction_` are forces times dt
    dt_ = around.scene.solver.dt;
    if (bdf2_) bdf2_->set_parameters(around);
    solver_.set_parameters(around);
    most_newton_steps_ = around.scene.solver.iterations;
    solved_way_ = solved_share * SurfacePairs::finest_edge(around.model);
    untaken_way_ = std::min(0.1 * solved_way_, untaken_share * gravity_at_least * dt_ * dt_);
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
    begin(state, row);
    taken_whole_ = true;
    bool moved = contact_ && begin_between_surfaces(state, row);  // from the step's start
    Solved solved;
    // With contact a solve may leave this share of the change to the next Newton step, whose pairs are
    // others: more exactness would be lost (inexact Newton: Dembo, Eisenstat & Steihaug 1982). A Newton step
    // squares the error, so it is the root of what the tolerance asks for in the end.
    const double left_share = contact_ ? std::sqrt(tolerance_) : 0.0;
    int most = most_newton_steps_;
    for (int newton = 0; newton < most; ++newton) {
      if (contact_ && moved) find_contact(state, false);
      set_up(newton == 0, !moved);
      if (newton == 0) improve_guess();
      if (newton == 0 || contact_)
        solver_.prepare(
            {position_, constraint_, contact_ ? contact_->term()->read() : std::vector<PressingPair>()},
            touches_);
      co_await solver_.solve(guess_, left_share, solved);
      for (int again = 0; contact_ && again < most_restarts && solved.lost_precision; ++again) {
        // The residual is computed anew, of what is solved so far.
        work_.linear_iterations += solved.iterations;
        dispatches_ += solved.dispatches;
        guess_.buffer.copy_from(solved.change->buffer);
        set_up(false, false);
        co_await solver_.solve(guess_, left_share, solved);
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

  /// Forgets the past velocities and all contacts with colliders: -1 is `untouched` in
  /// implicit_friction.glsl.
  void restart() override {
    const std::vector<float> untouched(contact_friction_.bytes() / sizeof(float), -1.0F);
    contact_friction_.upload(untouched.data(), contact_friction_.bytes());
    past_velocities_.fill(0);
    if (bdf2_) bdf2_->restart();
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
    work_ = {};
    co_await step(state, row);
    spent = work_;
  }

  void carry(Carrier& carrier) override {
    carrier.buffer(contact_friction_);
    carrier.buffer(past_velocities_);
    if (bdf2_) bdf2_->carry(carrier);
  }

  SolverWork work() const override { return work_; }

 private:
  ImplicitEuler(const model::Model& model, const Plan& plan)
      : groups_(vertex_groups(model.vertex_count())),
        touches_(plan.solid_count() > 0 && !plan.contact_term()),
        solver_(model) {
    const std::size_t vertex_count = model.vertex_count();
    for (gl::TextureBuffer* vector : {&start_position_, &start_velocity_, &position_, &velocity_, &guess_,
                                      &constraint_, &surface_, &block_a_, &block_b_})
      *vector = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    for (gl::TextureBuffer* of_each : {&trends_, &trend_products_})
      *of_each = {gl::Buffer(vertex_count * trends * 4 * sizeof(float)), GL_RGBA32F};
    if (!plan.contact_term()) {
      still_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
      still_.buffer.fill(0);
    } else {
      first_change_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    }
    past_velocities_ = gl::Buffer(vertex_count * trends * 4 * sizeof(float));
    contact_friction_ = gl::Buffer(vertex_count * 4 * sizeof(float));
  }

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
          untaken_way_(of.untaken_way_) {}
    ~Uncounted() {
      of_.dispatches_ = dispatches_;
      of_.work_ = work_;
      of_.most_newton_steps_ = most_newton_steps_;
      of_.set_tolerance(tolerance_);
      of_.solved_way_ = solved_way_;
      of_.untaken_way_ = untaken_way_;
    }
    Uncounted(const Uncounted&) = delete;

   private:
    ImplicitEuler& of_;
    std::uint64_t dispatches_;
    SolverWork work_;
    int most_newton_steps_;
    double tolerance_, solved_way_, untaken_way_;
  };

  std::vector<const gl::Program*> programs() const {
    std::vector<const gl::Program*> loaded;
    for (const gl::Program* program : {&start_, &first_, &system_, &project_, &improve_, &search_, &choose_,
                                       &advance_, &end_, &contacts_, &wind_})
      if (program->id()) loaded.push_back(program);
    return loaded;
  }

  /// Gives BDF2's equations their time in place of the step's length.
  void set_equation_time() {
    for (const gl::Program* program : programs()) program->set("dt", static_cast<float>(bdf2_->dt()));
    solver_.set_dt(bdf2_->dt());
    if (contact_) contact_->term()->set_dt(bdf2_->dt(), bdf2_->step_length());
  }

  void set_tolerance(double tolerance) {
    tolerance_ = tolerance;
    system_.set("tolerance", static_cast<float>(tolerance));
  }

  void run(const gl::Program& program) {
    program.use();
    dispatch(groups_);
    wait_for_writes();
  }

  void begin(StateBuffers& state, int row) {
    if (contact_) take_bodies(state, row);
    state.bind_for_step();
    bind_inputs(state);
    if (wind_.id()) {
      if (bdf2_ && bdf2_->by_formula()) expect();
      wind_loads_.buffer.bind_storage(slot_wind);
      wind_.set("start_row", row);
      run(wind_);
      state.bind_for_step();
    }
    if (bdf2_) bdf2_->bind_begin(start_);
    start_position_.buffer.bind_storage(slot_start_position);
    bind_estimate();
    if (contact_) first_change_.buffer.bind_storage(slot_first_change);
    start_.set("start_row", row);
    run(start_);
    if (!contact_) begin_with_velocity();
  }

  /// Makes the velocity at the step's start the first estimate, or the share of it that a line search finds
  /// best.
  void begin_with_velocity() {
    start_position_.bind(unit_position);
    still_.bind(unit_velocity);
    velocity_.bind(unit_change);
    solver_.sums().buffer.bind_storage(slot_group_sums);
    run(search_);
    position_.buffer.bind_storage(slot_next_position);
    bind_estimate();
    run(first_);
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

  /// Binds the state in which BDF2 takes the wind.
  void expect() {
    bdf2_->expect(expected_position_, expected_velocity_);
    expected_position_.bind(unit_position);
    expected_velocity_.bind(unit_velocity);
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

  void bind_inputs(const StateBuffers& state) {
    state.position().bind(unit_before_position);
    state.velocity().bind(unit_before_velocity);
    start_position_.bind(unit_start_position);
    start_velocity_.bind(unit_start_velocity);
    constraint_.bind(unit_constraint);
    surface_.bind(unit_surface);
    solver_.bind();
    block_a_.bind(unit_block_a);
    block_b_.bind(unit_block_b);
    if (wind_.id()) wind_loads_.bind(unit_wind);
  }

  /// Binds the buffers that the passes before and after a solve write.
  void bind_estimate() {
    start_velocity_.buffer.bind_storage(slot_start_velocity);
    velocity_.buffer.bind_storage(slot_estimate);
    guess_.buffer.bind_storage(slot_guess);
    constraint_.buffer.bind_storage(slot_constraint);
    surface_.buffer.bind_storage(slot_surface);
    contact_friction_.bind_storage(slot_grip);
  }

  /// Sets up the linear system at the present estimate. `first` in the time step; `exact`: the estimate is
  /// the state at the step's start.
  void set_up(bool first, bool exact) {
    position_.bind(unit_position);
    system_.set("first", first ? 1 : 0);
    system_.set("exact", contact_ && exact ? 1 : 0);
    velocity_.bind(unit_velocity);
    guess_.bind(unit_change);
    solver_.residual().buffer.bind_storage(slot_residual);
    block_a_.buffer.bind_storage(slot_block_a);
    block_b_.buffer.bind_storage(slot_block_b);
    trends_.buffer.bind_storage(slot_trends);
    past_velocities_.bind_storage(slot_past_velocities);
    run(system_);
  }

  /// Adds to the first guess what the last steps' velocities tell of this one's.
  void improve_guess() {
    solver_.residual().bind(unit_residual);
    trends_.bind(unit_trends);
    trend_products_.buffer.bind_storage(slot_trend_products);
    solver_.sums().buffer.bind_storage(slot_group_sums);
    run(project_);
    trend_products_.bind(unit_trend_products);
    solver_.residual().buffer.bind_storage(slot_residual);
    guess_.buffer.bind_storage(slot_guess);
    run(improve_);
  }

  /// Does the line search along a change.
  void search(const gl::TextureBuffer& change) {
    change.bind(unit_change);
    solver_.sums().buffer.bind_storage(slot_group_sums);
    run(search_);
  }

  /// Adds the share of the solved change that the line search found best to the estimate. `another`: a
  /// further Newton step may follow in this time step.
  void advance(int row, bool another) {
    position_.buffer.bind_storage(slot_next_position);
    bind_estimate();
    advance_.set("start_row", row);
    advance_.set("another", another ? 1 : 0);
    run(advance_);
  }

  /// Does the passes of self-collision. Each pass reads the velocities from one of two buffers and writes
  /// them to the other; after an even number of passes they are in `velocity_` again.
  void keep_apart() {
    static_assert(contact_passes % 2 == 0);
    position_.buffer.bind_storage(slot_next_position);
    for (int pass = 0; pass < contact_passes; ++pass) {
      (pass % 2 == 0 ? velocity_ : guess_).bind(unit_velocity);
      (pass % 2 == 0 ? guess_ : velocity_).buffer.bind_storage(slot_estimate);
      run(contacts_);
    }
  }

  void finish(StateBuffers& state, const gl::TextureBuffer& residual, int row) {
    position_.bind(unit_position);
    velocity_.bind(unit_velocity);
    residual.bind(unit_residual);
    contact_friction_.bind_storage(slot_grip);
    state.bind_outputs();
    end_.set("start_row", row);
    if (contact_) contact_->bind_end(end_);
    run(end_);
  }

  GLuint groups_;
  bool touches_;  ///< whether vertices may be kept at solids, which then press them by no force
  ConjugateGradients solver_;
  std::optional<Bdf2> bdf2_;  ///< none: implicit Euler
  double dt_ = 0;
  bool taken_whole_ = true;  ///< the step under way, but for what contact has kept it from
  int most_newton_steps_ = 1;
  double tolerance_ = 0;        ///< of a linear solve: relative, of the residual
  double untaken_way_ = 0;      ///< the most that a last Newton step may not take [m]
  double solved_way_ = 0;       ///< a Newton step that moves no vertex farther has solved the problem [m]
  std::uint32_t pressing_ = 0;  ///< pairs of surfaces that press at the present estimate
  gl::Program start_, system_, project_, improve_, search_, advance_, end_;
  gl::Program choose_;                                 ///< none without contact in the problem
  gl::Program first_;                                  ///< none with it
  gl::Program contacts_, wind_;                        ///< none if the scene has no self-collision, no wind
  gl::TextureBuffer start_position_, start_velocity_;  ///< state at the step's start, after self-collision
  gl::TextureBuffer position_, velocity_;              ///< estimate of the state at the step's end
  gl::TextureBuffer still_;                            ///< no velocity, for each vertex
  gl::TextureBuffer first_change_;          ///< with contact: of the estimate, before the first solve
  gl::TextureBuffer guess_;                 ///< first guess of the solved change of velocity
  gl::TextureBuffer constraint_, surface_;  ///< for each vertex: its contact with a collider
  gl::TextureBuffer wind_loads_;            ///< for each vertex: the wind at the step's start
  gl::TextureBuffer expected_position_, expected_velocity_;  ///< BDF2's, in which the wind is taken
  gl::Buffer contact_friction_;                              ///< friction of the contacts, kept between steps
  gl::TextureBuffer trends_, trend_products_;                ///< for each vertex `trends` vectors
  gl::Buffer past_velocities_;                               ///< at the starts of the last `trends` steps
  gl::TextureBuffer block_a_, block_b_;                      ///< each vertex' own block of the matrix
  SolverWork work_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_implicit_euler(const model::Model& model, const Plan& plan) {
  return ImplicitEuler::create(model, plan);
}

}  // namespace clothlab::sim
