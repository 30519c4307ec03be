// PBD, XPBD and VBD: runs shaders/methods/gauss_seidel.comp, for small cloths with one dispatch per step, for
// large ones with one dispatch for each phase and each colour.
#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "server/model/colouring.h"
#include "server/model/constraint_gains.h"
#include "server/scene/method.h"
#include "server/sim/coloured_work.h"
#include "server/sim/integrator.h"
#include "server/sim/sweep_form.h"

namespace clothlab::sim {

namespace {

/// Number of elements at a vertex.
std::uint64_t corners_at(const model::Model& model, std::uint32_t vertex) {
  std::uint64_t count = 0;
  model.elements.each([&](const auto& batch) {
    count += batch.at_vertex.offsets[vertex + 1] - batch.at_vertex.offsets[vertex];
  });
  return count;
}

gl::TextureBuffer per_vertex(std::uint32_t vertex_count) {
  return {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
}

class GaussSeidel : public Integrator {
 public:
  static Result<std::unique_ptr<Integrator>> create(const Surroundings& around, const Plan& plan) {
    std::unique_ptr<GaussSeidel> made(new GaussSeidel(around, plan));
    const Status loaded = made->lanes_ > 0 ? made->load_one_group(plan) : made->load_phases(plan);
    if (!loaded) return loaded.error();
    return std::unique_ptr<Integrator>(std::move(made));
  }

  void set_parameters(const Surroundings& around) override {
    listed_mobility_ = -1.0;  // the list follows from dt and the materials, too
    set_numbers(around);
  }

  void set_numbers(const Surroundings& around) override {
    sweeps_ = around.scene.solver.iterations;
    const double exact = model::mobility(around.scene);
    if (!by_vertex_ && exact != listed_mobility_) {
      visit_list_ = {gl::Buffer(visit_list(work_, around.model, around.scene)), GL_RGBA32UI};
      listed_mobility_ = exact;
    }
    const auto mobility = static_cast<float>(exact);
    for (const gl::Program* program : {&whole_, &begin_, &contacts_pass_, &balance_, &finish_})
      set_parameters(*program, around, mobility);
    for (const gl::Program& program : visits_) set_parameters(program, around, mobility);
    if (restores_momentum_) set_free_vertices(around);
  }

  Work step(StateBuffers& state, int row) override {
    state.bind_for_step();
    remainders_.bind_storage(slot_remainders);
    if (by_vertex_) {
      visited_.bind(unit_visited);
      velocity_before_.bind_storage(slot_velocity_before);
      targets_.bind_storage(slot_targets);
      if (restores_momentum_) momentum_sums_.bind_storage(slot_lacking);
    } else {
      visit_list_.bind(unit_visits);
      if (pushes_.buffer.bytes() > 0) {
        pushes_.bind(unit_pushed);
        pushes_.buffer.bind_storage(slot_pushed);
      }
    }
    if (lanes_ > 0)
      step_in_one_group(row);
    else
      co_await step_in_phases(row);
    state.swap();
  }

  /// Forgets what rounding took from the last state and, for VBD, the velocity at the last step's start.
  void restart() override {
    remainders_.fill(0);
    if (by_vertex_) velocity_before_.fill(0);
  }

  int iterations() const override { return sweeps_; }

  Work again(StateBuffers& state, int row) override {
    const Uncounted uncounted(*this);
    co_await step(state, row);
  }

  void carry(Carrier& carrier) override {
    carrier.buffer(remainders_);
    if (by_vertex_) carrier.buffer(velocity_before_);
  }

 private:
  GaussSeidel(const Surroundings& around, const Plan& plan)
      : by_vertex_(scene::sweeps_vertices(plan.method)),
        contacts_(plan.self_collision || (!by_vertex_ && plan.solid_count() > 0)),
        restores_momentum_(by_vertex_ && plan.solid_count() == 0),
        vertex_count_(around.model.vertex_count()),
        cloths_(static_cast<std::uint32_t>(around.model.cloths.size())),
        work_(by_vertex_ ? visited_vertices(around.model, around.scene)
                         : visited_elements(around.model, around.scene)) {
    lanes_ = lanes_of_one_group({vertex_count_, work_.colours() + (contacts_ ? 1 : 0), by_vertex_,
                                 plan.self_collision,
                                 [&](std::uint32_t lanes) { return turns(around.model, plan, lanes); }});
    remainders_ = gl::Buffer(vertex_count_ * 8 * sizeof(float));
    if (by_vertex_) {
      visited_ = {gl::Buffer(work_.order), GL_R32UI};
      velocity_before_ = gl::Buffer(vertex_count_ * 4 * sizeof(float));
      targets_ = gl::Buffer(vertex_count_ * 4 * sizeof(float));
      if (restores_momentum_)
        momentum_sums_ = gl::Buffer(cloths_ * std::size_t{group_size} * 4 * sizeof(float));
    } else if (plan.method == scene::Method::xpbd) {
      pushes_ = {gl::Buffer(std::max<std::size_t>(remembered_pushes(work_), 1) * 4 * sizeof(float)),
                 GL_RGBA32F};
    }
    if (lanes_ > 0) return;
    for (gl::TextureBuffer& deviation : deviation_) deviation = per_vertex(vertex_count_);
  }

  /// While it lives, what is dispatched is not counted; it may end half-way.
  class Uncounted {
   public:
    explicit Uncounted(GaussSeidel& of) : of_(of), dispatches_(of.dispatches_) {}
    ~Uncounted() { of_.dispatches_ = dispatches_; }
    Uncounted(const Uncounted&) = delete;

   private:
    GaussSeidel& of_;
    std::uint64_t dispatches_;
  };

  /// Upper bound of the turns that one thread takes in all loops of a step, if the work group has `lanes`
  /// threads.
  std::uint64_t turns(const model::Model& model, const Plan& plan, std::uint32_t lanes) const {
    const auto rounds = [&](std::uint32_t items) { return std::uint64_t{(items + lanes - 1) / lanes}; };
    const std::uint64_t colliders = 2 + 6 * static_cast<std::uint64_t>(plan.solid_count());
    std::uint64_t visit = 1;
    for (std::uint32_t i = 0; by_vertex_ && i < vertex_count_; ++i)
      visit = std::max(visit, colliders + 1 + corners_at(model, i));
    std::uint64_t sweep = 0;
    for (std::uint32_t colour = 0; colour < work_.colours(); ++colour)
      sweep += 1 + rounds(work_.offsets[colour + 1] - work_.offsets[colour]) * visit;
    const std::uint64_t balance =
        restores_momentum_ ? cloths_ * (2 * rounds(vertex_count_) + 2 * std::uint64_t{group_size}) : 0;
    if (contacts_)
      sweep += rounds(vertex_count_) * (colliders + (plan.self_collision ? plan.neighbour_slots : 0));
    std::uint64_t fan = 0;
    const std::vector<std::uint32_t>& fans = model.vertex_triangles.offsets;
    for (std::uint32_t i = 0; plan.wind && i < vertex_count_; ++i)
      fan = std::max<std::uint64_t>(fan, fans[i + 1] - fans[i]);
    return static_cast<std::uint64_t>(plan.most_sweeps) * sweep + balance +
           rounds(vertex_count_) * (2 * colliders + fan);
  }

  gl::Defines defines(const Plan& plan) const {
    gl::Defines list = step_defines(plan);
    for (gl::Defines::value_type& define : visit_defines(work_, !by_vertex_))
      list.push_back(std::move(define));
    if (by_vertex_) list.emplace_back("BY_VERTEX", "1");
    if (plan.method == scene::Method::xpbd) list.emplace_back("MEMORY", "1");
    if (contacts_) list.emplace_back("CONTACTS", "1");
    if (restores_momentum_) {
      list.emplace_back("BALANCED", "1");
      list.emplace_back("CLOTH_COUNT", std::to_string(cloths_));
    }
    return list;
  }

  void set_parameters(const gl::Program& program, const Surroundings& around, float mobility) const {
    if (!program.id()) return;
    set_step_uniforms(program, around);
    program.set("mobility", mobility);
    program.set("last_sweep", sweeps_ - 1);
  }

  Status load_one_group(const Plan& plan) {
    gl::Defines list = defines(plan);
    for (auto& [name, value] : list)
      if (name == "GROUP_SIZE") value = std::to_string(lanes_);
    list.emplace_back("SLICE_SIZE", std::to_string(group_size));
    list.emplace_back("ONE_GROUP", "1");
    list.emplace_back("VERTEX_ROOM", std::to_string(vertex_room(vertex_count_, plan.self_collision)));
    list.emplace_back("COLOUR_ROOM", std::to_string(std::bit_ceil(work_.offsets.size())));
    Result<gl::Program> loaded = gl::Program::load({"methods/gauss_seidel.comp"}, list);
    if (!loaded) return loaded.error();
    whole_ = std::move(*loaded);
    const std::vector<GLint> first(work_.offsets.begin(), work_.offsets.end());
    glProgramUniform1iv(whole_.id(), whole_.location("colour_first"), static_cast<GLsizei>(first.size()),
                        first.data());
    set_visits(whole_, work_, !by_vertex_);
    return ok();
  }

  Status load_phases(const Plan& plan) {
    visits_.resize(work_.functions.size());
    std::vector<std::pair<gl::Program*, std::string>> phases{
        {&begin_, "begin"}, {&contacts_pass_, "meet"}, {&finish_, "finish"}};
    for (std::size_t k = 0; k < visits_.size(); ++k)
      if (work_.functions[k].visits()) phases.emplace_back(&visits_[k], work_.functions[k].name);
    for (auto& [program, phase] : phases) {
      gl::Defines list = defines(plan);
      list.emplace_back("PHASE", phase);
      Result<gl::Program> loaded = gl::Program::load({"methods/gauss_seidel.comp"}, list);
      if (!loaded) return loaded.error();
      *program = std::move(*loaded);
      set_visits(*program, work_, !by_vertex_);
    }
    if (!restores_momentum_) return ok();
    gl::Defines list = defines(plan);
    list.emplace_back("EACH_CLOTH", "1");
    Result<gl::Program> loaded = gl::Program::load({"methods/gauss_seidel.comp"}, list);
    if (!loaded) return loaded.error();
    balance_ = std::move(*loaded);
    return ok();
  }

  /// Sets the uniform `free_vertices`: for each cloth the first and the end of its vertices, an empty range
  /// if the cloth has pins.
  void set_free_vertices(const Surroundings& around) {
    std::vector<GLint> ranges;
    for (const model::ClothRange& cloth : around.model.cloths) {
      const auto first = around.model.pin_motion.begin() + cloth.first_vertex,
                 end = first + cloth.vertex_count;
      const bool free = std::all_of(first, end, [](std::int32_t pin) { return pin == model::not_pinned; });
      ranges.push_back(static_cast<GLint>(cloth.first_vertex));
      ranges.push_back(static_cast<GLint>(cloth.first_vertex + (free ? cloth.vertex_count : 0)));
    }
    const gl::Program& program = lanes_ > 0 ? whole_ : balance_;
    glProgramUniform2iv(program.id(), program.location("free_vertices"),
                        static_cast<GLsizei>(ranges.size() / 2), ranges.data());
  }

  void step_in_one_group(int row) {
    whole_.use();
    whole_.set("start_row", row);
    dispatch(1);
    wait_for_writes();
  }

  Work step_in_phases(int row) {
    std::size_t current = 0;
    const auto run = [&](const gl::Program& program, std::uint32_t first, std::uint32_t end) {
      program.set("first", static_cast<GLint>(first));
      program.set("end", static_cast<GLint>(end));
      dispatch(vertex_groups(end - first));
      wait_for_writes();
    };
    const auto use = [&](const gl::Program& program, std::size_t read, std::size_t written) {
      program.use();
      program.set("start_row", row);
      deviation_[read].bind(unit_deviation);
      deviation_[written].buffer.bind_storage(slot_deviation);
    };
    use(begin_, current, current);
    run(begin_, 0, vertex_count_);
    for (int sweep = 0; sweep < sweeps_; ++sweep) {
      for (std::size_t k = 0; k < visits_.size(); ++k) {
        const Visits::Function& function = work_.functions[k];
        if (!function.visits()) continue;
        use(visits_[k], current, current);
        visits_[k].set("sweep", sweep);
        for (std::uint32_t colour = function.first_colour; colour < function.end_colour; ++colour) {
          run(visits_[k], work_.offsets[colour], work_.offsets[colour + 1]);
          co_await may_stop;
        }
      }
      if (!contacts_) continue;
      use(contacts_pass_, current, 1 - current);
      run(contacts_pass_, 0, vertex_count_);
      current = 1 - current;
      co_await may_stop;
    }
    if (restores_momentum_) {
      use(balance_, current, current);
      dispatch(cloths_);
      wait_for_writes();
    }
    use(finish_, current, current);
    run(finish_, 0, vertex_count_);
  }

  bool by_vertex_, contacts_;
  bool restores_momentum_;   ///< VBD without colliders: keep sweeps from giving free cloths a false momentum
  std::uint32_t lanes_ = 0;  ///< threads of the one work group; 0: many dispatches instead
  std::uint32_t vertex_count_, cloths_;
  int sweeps_ = 1;
  double listed_mobility_ = -1.0;  ///< model::mobility that the list of visits has; below 0 before the first
  Visits work_;                    ///< what a sweep visits
  gl::Program whole_, begin_, contacts_pass_, balance_, finish_;
  std::vector<gl::Program> visits_;  ///< for each of work_.functions; without a program if it has no items
  std::array<gl::TextureBuffer, 2> deviation_;  ///< a pass of contacts reads one and writes the other
  gl::TextureBuffer visit_list_, visited_, pushes_;
  gl::Buffer targets_, velocity_before_, momentum_sums_, remainders_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_gauss_seidel(const Surroundings& around, const Plan& plan) {
  return GaussSeidel::create(around, plan);
}

}  // namespace clothlab::sim
