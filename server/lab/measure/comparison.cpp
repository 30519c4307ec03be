#include "server/lab/measure/comparison.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/automatic.h"
#include "server/lab/measure/stepping.h"
#include "server/lab/measure/truth.h"
#include "server/model/size.h"
#include "server/model/stability.h"
#include "server/reference/follower.h"

namespace clothlab::lab {

namespace {

using scene::Document;

constexpr double same_time = 1e-6;           // two times that differ by less, in steps, are the same
constexpr double accuracy_aimed_for = 1e-6;  // of the reference: RMS over the cloth's size at the horizon
constexpr double search_budget = 20.0;       // wall time to look for the reference's step [s]
constexpr double stiff_budget = 60.0;        // the same for a scene that is too stiff for RK4 [s]
constexpr double search_share = 0.4;         // of the job's progress: looking for it

/// Positions as they are told, in 32-bit floats.
template <class Vector>
std::vector<float> told(const std::vector<Vector>& positions) {
  std::vector<float> floats;
  floats.reserve(3 * positions.size());
  for (const Vector& x : positions)
    for (int axis = 0; axis < 3; ++axis) floats.push_back(static_cast<float>(x[axis]));
  return floats;
}

/// A side that is stepped on the GPU as the scene says.
class Stepped {
 public:
  explicit Stepped(std::unique_ptr<sim::Simulation> simulation)
      : simulation_(std::move(simulation)), guard_(*simulation_), stepping_(*simulation_) {
    guard_.start(model::dt_limit_if_near(simulation_->model(), simulation_->scene()));
    look(after_);
  }

  const model::Model& model() const { return simulation_->model(); }

  /// Steps until the moment `time` [s] is not after the last step. Fills `side` if the run blows up.
  Status go_to(double time, const std::stop_token& stop, ComparedSide& side) {
    const double dt = simulation_->scene().solver.dt;
    while (after_.time < time - same_time * dt) {
      const double left = (time - after_.time) / dt;
      auto whole = static_cast<std::uint64_t>(std::floor(left + same_time));
      const bool between = whole == 0;
      if (between) before_ = std::move(after_);
      for (whole = std::max<std::uint64_t>(whole, 1); whole > 0;) {
        if (stop.stop_requested()) return cancelled;
        whole -= stepping_.step(whole);
      }
      look(after_);
      if (guard_.judge_now() != sim::GuardedRun::Verdict::blown_up) continue;
      side.blew_up_at = after_.time;
      side.reason = guard_.reason();
      break;
    }
    return ok();
  }

  std::vector<float> positions(double time) const {
    const double dt = simulation_->scene().solver.dt;
    if (std::abs(after_.time - time) <= same_time * dt) return told(after_.position);
    const auto share = static_cast<float>((time - before_.time) / (after_.time - before_.time));
    std::vector<glm::vec3> between(after_.position.size());
    for (std::size_t i = 0; i < between.size(); ++i)
      between[i] = glm::mix(before_.position[i], after_.position[i], share);
    return told(between);
  }

  bool colliders_move() const { return scene::any_has_motion(simulation_->scene().colliders); }
  std::vector<scene::Collider> colliders() const { return simulation_->colliders_now(); }

 private:
  struct Look {
    double time = 0;  ///< [s]
    std::vector<glm::vec3> position;
  };
  void look(Look& at) { at = {simulation_->time(), simulation_->read_state().position}; }

  std::unique_ptr<sim::Simulation> simulation_;
  sim::GuardedRun guard_;
  Stepping stepping_;
  Look before_, after_;  // the last two steps looked at
};

Result<std::unique_ptr<Stepped>> stepped(const Document& document) {
  Result<std::unique_ptr<sim::Simulation>> simulation = sim::Simulation::create(document.scene);
  if (!simulation) return simulation.error();
  return std::make_unique<Stepped>(std::move(*simulation));
}

class Comparing {
 public:
  Comparing(const Document& document, const CompareRequest& request, const Control<Comparison>& control)
      : document_(document), request_(request), control_(control) {}

  Result<Comparison> run() {
    if (Status made = make_sides(); !made) return made.error();
    const auto count = static_cast<std::size_t>(std::floor(found_.time * request_.rate + 1e-9));
    for (std::size_t k = 0; k <= count; ++k) {
      const double time = static_cast<double>(k) / request_.rate;
      if (Status gone = go_to(time); !gone) {
        if (was_cancelled(gone.error()) && !found_.moments.empty()) return found_;
        return gone.error();
      }
      if (found_.a.blew_up_at || found_.b.blew_up_at) break;
      add(time);
      const double begun = request_.truth ? search_share : 0.0;
      const double share = static_cast<double>(k) / static_cast<double>(std::max<std::size_t>(count, 1));
      control_.progress(
          {begun + (1.0 - begun) * share, 1.0, "both sides, " + with_significant_digits(time, 3) + " s"});
      control_.arrived(found_);
    }
    tell_blow_up("A", found_.a);
    tell_blow_up("B", found_.b);
    found_.complete = true;
    control_.progress({1.0, 1.0, "done"});
    return found_;
  }

 private:
  Status make_sides() {
    Result<Document> patched = scene::apply_patch(document_, request_.patch);
    if (!patched) return patched.error();
    if (Status fits =
            check_sizes(model::size_of(document_.scene).vertices, model::size_of(patched->scene).vertices);
        !fits)
      return fits;
    const Result<Document> a = with_provisional_setting(document_), b = with_provisional_setting(*patched);
    if (!a) return a.error();
    if (!b) return b.error();
    found_.scene = document_.scene.name;
    found_.renderer = gl::renderer_name();
    found_.rate = request_.rate;
    found_.time = request_.time;
    found_.truth = request_.truth;
    found_.a.setting = setting_of((request_.truth ? *b : *a).scene);
    found_.b.setting = setting_of(b->scene);
    Result<std::unique_ptr<Stepped>> side = stepped(*b);
    if (!side) return side.error();
    b_ = std::move(*side);
    found_.vertices = b_->model().vertex_count();
    if (request_.truth) return find_truth(b->scene);
    side = stepped(*a);
    if (!side) return side.error();
    a_ = std::move(*side);
    const bool same = a_->model().triangles == b_->model().triangles &&
                      a_->model().vertex_cloth == b_->model().vertex_cloth;
    return same ? ok() : Status(other_mesh("triangles between other vertices"));
  }

  static Error other_mesh(const std::string& found) {
    return {"/patch", "B's cloth has " + found,
            "a patch that leaves the cloths' meshes as they are: vertices are compared one by one"};
  }

  Status check_sizes(std::size_t a, std::size_t b) const {
    if (a != b) return other_mesh(std::to_string(b) + " vertices, A's " + std::to_string(a));
    if (a > max_compared_vertices)
      return Error{"/cloths", std::to_string(a) + " vertices",
                   "at most " + std::to_string(max_compared_vertices) + " to be compared; a coarser mesh"};
    const std::size_t bytes_a_moment = 2 * 3 * sizeof(float) * a;
    const double most = std::floor(static_cast<double>(max_comparison_bytes / bytes_a_moment - 1)) /
                        request_.rate;  // the start is a moment, too
    if (request_.time <= most) return ok();
    return Error{"/time",
                 with_significant_digits(request_.time, 4) + " s of " + std::to_string(a) + " vertices",
                 "at most " + with_significant_digits(std::floor(100.0 * most) / 100.0, 4) +
                     " s of them: all moments are kept in memory"};
  }

  /// Looks for the reference's step, and for how long positions can be compared.
  Status find_truth(const scene::Scene& scene) {
    const auto progress = [this](double share) {
      control_.progress({search_share * share, 1.0, "the truth, in double precision"});
    };
    progress(0.0);
    Result<Truth> truth = lab::truth(scene, {request_.time, accuracy_aimed_for, search_budget, stiff_budget},
                                     control_.stop, progress);
    if (!truth) return truth.error();
    if (!truth->why_no_reference.empty()) return no_truth(truth->why_no_reference);
    if (truth->horizon == 0.0) return no_truth(truth->horizon_reason);
    found_.time = truth->time;
    found_.horizon = truth->horizon;
    found_.reference_error = truth->position_error;
    found_.notes = truth->notes;
    found_.notes.push_back(truth->horizon_reason);
    reference_ = reference::at_rest(truth->world);
    follower_.emplace(std::move(truth->world), truth->pace, control_.stop);
    return ok();
  }

  static Error no_truth(const std::string& why) {
    return {"truth", "there is none for this scene: " + why, "compare with the present settings instead"};
  }

  Status go_to(double time) {
    if (a_)
      if (Status gone = a_->go_to(time, control_.stop, found_.a); !gone) return gone;
    if (follower_ && time > reference_time_) {
      if (!follower_->follow(reference_, reference_time_, time)) return cancelled;
      reference_time_ = time;
    }
    return b_->go_to(time, control_.stop, found_.b);
  }

  void add(double time) {
    auto moment = std::make_shared<Moment>();
    moment->time = time;
    moment->a = a_ ? a_->positions(time) : told(reference_.position);
    moment->b = b_->positions(time);
    const Stepped& colliders = a_ ? *a_ : *b_;
    if (colliders.colliders_move()) moment->colliders = colliders.colliders();
    double squares = 0.0;
    for (std::size_t i = 0; i < moment->a.size(); i += 3) {
      double square = 0.0;
      for (std::size_t axis = i; axis < i + 3; ++axis) {
        const double off = static_cast<double>(moment->a[axis]) - static_cast<double>(moment->b[axis]);
        square += off * off;
      }
      squares += square;
      moment->most = std::max(moment->most, std::sqrt(square));
    }
    moment->rms = std::sqrt(3.0 * squares / static_cast<double>(std::max<std::size_t>(moment->a.size(), 1)));
    found_.moments.push_back(std::move(moment));
  }

  void tell_blow_up(const std::string& side, const ComparedSide& of) {
    if (!of.blew_up_at) return;
    found_.notes.push_back(side + " blew up after " + with_significant_digits(*of.blew_up_at, 3) +
                           " s, where the comparison ends: " + of.reason + ".");
  }

  const Document& document_;
  const CompareRequest& request_;
  const Control<Comparison>& control_;
  Comparison found_;
  std::unique_ptr<Stepped> a_, b_;  // a_: null where A is the truth
  std::optional<reference::Follower> follower_;
  reference::State reference_;
  double reference_time_ = 0;  // [s]
};

}  // namespace

Result<Comparison> compare(const Document& document, const CompareRequest& request,
                           const Control<Comparison>& control) {
  return Comparing(document, request, control).run();
}

}  // namespace clothlab::lab
