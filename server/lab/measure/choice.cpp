#include "server/lab/measure/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/choice_words.h"
#include "server/lab/measure/second_look.h"
#include "server/lab/measure/spread.h"
#include "server/lab/measure/step_search.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"
#include "server/lab/measure/whole_time.h"
#include "server/model/stability.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

using scene::Method;

/// Wall time to spend on the reference [s]; the second where a scene is too stiff for RK4.
constexpr double reference_budget = 30.0, stiff_reference_budget = 120.0;
constexpr int rounds = 7;       // chance that all are above the median: 1/128
constexpr int looks_again = 3;  // looks at a candidate at most, see bound_errors()
/// A candidate that blows up for want of a margin gets a step shorter by this factor, this often at most: a
/// cloth that its weight stretches may be some times as stiff as about the shape of rest.
constexpr double shorter_for_margin = 0.8;
constexpr int most_margins = 8;
/// A candidate with which something is wrong beyond the horizon tries half of its step, this often at most.
constexpr int most_halvings = 2;
constexpr double longest_choice_timing = 0.2;  // wall time of one timing at most [s]
constexpr double progress_after_truth = 0.3, progress_after_search = 0.9;  // of the progress, at their ends

class Chooser {
 public:
  Chooser(const scene::Scene& scene, const ChooseRequest& request, const Control<Choice>& control)
      : scene_(scene), request_(request), control_(control) {}

  Result<Choice> choose() {
    choice_.scene = scene_.name;
    choice_.renderer = gl::renderer_name();
    choice_.tolerance = request_.tolerance;
    if (Status computed = compute_truth(); !computed) return computed.error();
    search_.emplace(scene_, truth_, request_.tolerance, trials_, control_.stop);
    if (Status listed = search_->list(request_.methods); !listed) return listed.error();
    if (truth_.horizon < truth_.asked)
      whole_time_.emplace(scene_, truth_, request_.tolerance, trials_, control_.stop);
    choice_.notes.insert(choice_.notes.end(), search_->notes().begin(), search_->notes().end());
    if (Status measured = measure_present(); !measured) return measured.error();
    std::vector<Candidate>& candidates = search_->candidates();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      control_.progress(
          {progress_after_truth + (progress_after_search - progress_after_truth) * static_cast<double>(i) /
                                      static_cast<double>(candidates.size()),
           1.0, text(candidates[i].setting)});
      if (Status searched = search_->search(candidates[i]); !searched) return searched.error();
      if (Status kept = shorten_for_whole_time(candidates[i]); !kept) return kept.error();
      choice_.tried = search_->tried();
      control_.arrived(choice_);
    }
    if (Status decided = decide(); !decided) return decided.error();
    choice_.complete = true;
    control_.progress({1.0, 1.0, "done"});
    return choice_;
  }

 private:
  Status compute_truth() {
    const auto progress = [this](double share) {
      control_.progress({share * progress_after_truth, 1.0, "the reference, in double precision"});
    };
    const double accuracy = std::min(1e-7, 1e-3 * request_.tolerance);
    Result<Truth> found =
        truth(scene_, {request_.time.value_or(1.0), accuracy, reference_budget, stiff_reference_budget},
              control_.stop, progress);
    if (!found) return found.error();
    truth_ = std::move(*found);
    choice_.time = truth_.time;
    choice_.asked = truth_.asked;
    choice_.horizon = truth_.horizon;
    choice_.horizon_reason = truth_.horizon_reason;
    choice_.reference_error = truth_.position_error / truth_.size;
    choice_.notes = truth_.notes;
    if (!truth_.why_no_reference.empty())
      return Error{"choose", "there is no reference: " + truth_.why_no_reference,
                   "the chart still shows what each method costs and what blows up"};
    if (truth_.horizon == 0.0)
      return Error{
          "choose", "positions cannot be compared: " + truth_.horizon_reason,
          "the chart still compares energy, the largest strain and, where there is one, the shape of rest"};
    if (choice_.reference_error > 0.3 * request_.tolerance)
      return Error{"choose",
                   "the reference itself is known to " + with_significant_digits(choice_.reference_error, 3) +
                       " of the cloth's size only, a tolerance of " +
                       with_significant_digits(request_.tolerance, 3) + " was asked for",
                   "a tolerance of " + with_significant_digits(choice_.reference_error / 0.3, 3) +
                       " or more, or a shorter time"};
    return ok();
  }

  /// Whether nothing speaks against a setting up to the time that was asked for, where the reference ends
  /// earlier. If something does and `tell`, a note says what; `name`: the setting's, in the note.
  Result<bool> keeps_whole_time(const Setting& setting, const std::string& name, bool tell) {
    if (!whole_time_) return true;
    const Result<std::string> fault = whole_time_->fault(setting);
    if (!fault) return fault.error();
    if (tell && !fault->empty())
      choice_.notes.push_back(name + " keeps the tolerance up to " +
                              with_significant_digits(truth_.horizon, 3) + " s, but " + *fault + ".");
    return fault->empty();
  }

  /// A candidate with which something is wrong beyond the horizon gets a shorter step, or leaves the race.
  Status shorten_for_whole_time(Candidate& candidate) {
    for (int halving = 0; candidate.best; ++halving) {
      const Setting setting = candidate.best->setting;
      const bool last = halving == most_halvings;
      const Result<bool> keeps = keeps_whole_time(setting, text(setting), halving == 0 || last);
      if (!keeps) return keeps.error();
      if (*keeps) return ok();
      candidate.best.reset();
      if (last || !search_->may_compete(candidate, 0.5 * setting.dt)) return ok();
      const Result<double> error = search_->step_at(candidate, 0.5 * setting.dt);
      if (!error) return error.error();
      if (*error > request_.tolerance) candidate.best.reset();
    }
    return ok();
  }

  Status measure_present() {
    Candidate present{setting_of(scene_), search_->limit_of(scene_.solver.method), worst, {}};
    const Result<double> error = search_->error_at(present, scene_.solver.dt, choice_.present);
    if (!error) return error.error();
    return ok();
  }

  /// Looks again, at every step or nearly, at the errors of the candidates in the race, for bounds that a
  /// choice may promise. A candidate whose upper bound misses the tolerance tries shorter steps, and leaves
  /// the race if that does not help.
  Status bound_errors(std::vector<Candidate*>& race) {
    std::vector<Candidate*> open = race;
    bool present = choice_.present.largest_position_error.has_value();
    for (int look = 0; look < looks_again && !open.empty(); ++look) {
      std::vector<Setting> settings;
      for (const Candidate* candidate : open) settings.push_back(candidate->best->setting);
      if (present) settings.push_back(choice_.present.setting);
      const auto errors = measure_largest_errors(scene_, truth_, settings, trials_, control_.stop);
      if (!errors) return errors.error();
      if (present) set_error(choice_.present, errors->back());
      present = false;
      std::vector<Candidate*> again;
      for (std::size_t i = 0; i < open.size(); ++i) {
        set_error(*open[i]->best, (*errors)[i]);
        const double high = (*errors)[i] ? (*errors)[i]->high : worst;
        if (high <= request_.tolerance) continue;
        again.push_back(open[i]);
        if (look + 1 == looks_again || high == worst) continue;
        const Result<double> shorter = search_->shorten(*open[i], high);
        if (!shorter) return shorter.error();
      }
      open = std::move(again);
    }
    choice_.tried = search_->tried();
    for (const Candidate* candidate : open) {
      choice_.notes.push_back(text(candidate->best->setting) +
                              " seemed to keep the tolerance, but does not at every step.");
      std::erase(race, candidate);
    }
    return ok();
  }

  static void set_error(Point& point, const std::optional<LargestError>& error) {
    if (!error) return;
    point.largest_position_error = error->seen;
    point.error_low = error->low;
    point.error_high = error->high;
  }

  /// Times the candidates in the race and the scene's own setting, in turns.
  Status time_race(std::vector<Candidate*>& race) {
    std::vector<scene::Scene> scenes;
    for (const Candidate* candidate : race) scenes.push_back(with(scene_, candidate->best->setting));
    const bool present = choice_.present.cost.has_value();
    if (present) scenes.push_back(with(scene_, choice_.present.setting));
    Result<std::vector<std::vector<double>>> measured =
        trials_.time(scenes, truth_.horizon, longest_choice_timing, rounds, control_.stop);
    if (!measured) return measured.error();
    for (std::size_t i = 0; i < race.size(); ++i) {
      race[i]->best->cost = cost_of((*measured)[i]);
      race[i]->times = (*measured)[i];
    }
    if (present) choice_.present.cost = cost_of(present_times_ = measured->back());
    return ok();
  }

  Status decide() {
    std::vector<Candidate*> race;
    double best = worst;
    for (const Candidate& candidate : search_->candidates())
      if (candidate.best) best = std::min(best, candidate.best->cost->median);
    for (Candidate& candidate : search_->candidates())
      if (candidate.best && candidate.best->cost->median <= close_race * best) race.push_back(&candidate);
    if (race.empty()) return give_most_accurate();
    add_runner_up(race);
    for (int margins = 0; margins < most_margins && !choice_.met; ++margins) {
      control_.progress({progress_after_search, 1.0, "looking at the best at every step"});
      if (Status looked = bound_errors(race); !looked) return looked;
      if (race.empty()) return give_most_accurate();
      control_.progress({0.5 * (1.0 + progress_after_search), 1.0, "timing the best, taking turns"});
      if (Status timed_all = time_race(race); !timed_all) return timed_all;
      std::sort(race.begin(), race.end(), [](const Candidate* a, const Candidate* b) {
        return a->best->cost->median < b->best->cost->median;
      });
      if (Status picked = pick(race); !picked) return picked;
    }
    choice_.tried = search_->tried();
    if (!choice_.met) return give_most_accurate();
    for (const Candidate* candidate : race)
      if (!choice_.runner_up && candidate->setting.method != choice_.chosen.setting.method) {
        choice_.runner_up = *candidate->best;
        runner_up_times_ = candidate->times;
      }
    choice_.why = why_chosen(choice_, ratio_to_runner_up(), for_margin_);
    return let_present_take_part();
  }

  /// The scene's own setting stays if it keeps the tolerance with a margin and nothing is sure to be cheaper.
  Status let_present_take_part() {
    const Result<bool> keeps = present_keeps();
    if (!keeps) return keeps.error();
    if (!*keeps) return ok();
    const Point& present = choice_.present;
    if (choice_.met) {
      if (cheaper_or_closer(choice_.chosen, present)) return ok();
      if (choice_.chosen.setting.method != present.setting.method) choice_.runner_up = choice_.chosen;
    }
    choice_.met = true;
    choice_.chosen = present;
    choice_.why = why_present(choice_);
    return ok();
  }

  /// True if `chosen` is surely cheaper than the present setting, or seems so and is more exact, too.
  bool cheaper_or_closer(const Point& chosen, const Point& present) const {
    Setting same_step = chosen.setting;
    same_step.dt = present.setting.dt;
    // Steps of one kind cost the same: then no clock need judge.
    if (same_step == present.setting) return chosen.setting.dt > present.setting.dt;
    return chosen.cost->median < present.cost->median &&
           (ratio(present_times_, chosen_times_).low > 1.0 ||
            *chosen.largest_position_error < *present.largest_position_error);
  }

  /// True if the scene's own setting may be chosen: it is of a wanted method and keeps the tolerance at every
  /// step, with a margin of stability.
  Result<bool> present_keeps() {
    Point& present = choice_.present;
    const std::vector<Method>& wanted = request_.methods;
    const bool is_wanted =
        wanted.empty() || std::find(wanted.begin(), wanted.end(), present.setting.method) != wanted.end();
    if (!is_wanted || !present.cost || present.dt_over_limit.value_or(0.0) > model::margin_to_warn)
      return false;
    if (!present.error_high) {
      const auto errors = measure_largest_errors(scene_, truth_, {present.setting}, trials_, control_.stop);
      if (!errors) return errors.error();
      set_error(present, errors->front());
    }
    if (present.error_high.value_or(worst) > request_.tolerance) return false;
    const Result<bool> keeps = keeps_whole_time(present.setting, "The scene's own setting", true);
    if (!keeps || !*keeps) return keeps;
    return keeps_margin(present);
  }

  /// Chooses the cheapest in the race if it holds with a margin. Those that do not get a shorter step, down
  /// to the first that does; then all must be looked at and timed again.
  Status pick(std::vector<Candidate*>& race) {
    bool shortened = false;
    std::vector<Candidate*> out;
    for (Candidate* candidate : race) {
      const Result<bool> holds = keeps_margin(*candidate->best);
      if (!holds) return holds.error();
      if (*holds && !shortened) {
        choice_.met = true;
        choice_.chosen = *candidate->best;
        chosen_times_ = candidate->times;
        for_margin_ = candidate->for_margin;
      }
      if (*holds) break;
      shortened = candidate->for_margin = true;
      const Result<double> error =
          search_->step_at(*candidate, shorter_for_margin * candidate->best->setting.dt);
      if (!error) return error.error();
      if (*error == worst) out.push_back(candidate);
    }
    for (const Candidate* candidate : out) std::erase(race, candidate);
    return ok();
  }

  /// Adds to the race the cheapest candidate whose method is not that of the cheapest in the race.
  void add_runner_up(std::vector<Candidate*>& race) {
    const Method winner =
        (*std::min_element(race.begin(), race.end(), [](const Candidate* a, const Candidate* b) {
          return a->best->cost->median < b->best->cost->median;
        }))->setting.method;
    Candidate* second = nullptr;
    for (Candidate& candidate : search_->candidates())
      if (candidate.best && candidate.setting.method != winner &&
          (!second || candidate.best->cost->median < second->best->cost->median))
        second = &candidate;
    if (second && std::find(race.begin(), race.end(), second) == race.end()) race.push_back(second);
  }

  /// True if the setting does not blow up within the time that was asked for, neither at its own step nor, if
  /// its method has a step limit, at a step a ninth longer.
  Result<bool> keeps_margin(const Point& point) {
    scene::Scene scene = with(scene_, point.setting);
    std::vector<double> steps{scene.solver.dt};
    if (!scene::any_step_is_stable(point.setting.method))
      steps.push_back(scene.solver.dt / model::margin_to_warn);
    for (const double dt : steps) {
      scene.solver.dt = dt;
      const Result<Trial> trial = trials_.run(scene, truth_, truth_.asked, control_.stop);
      if (!trial) return trial.error();
      if (!trial->blew_up_at) continue;
      choice_.notes.push_back(text(point.setting) + " keeps the tolerance, but blows up " +
                              (dt == steps.front() ? "later" : "with a step a ninth longer") + ", at " +
                              with_significant_digits(*trial->blew_up_at, 3) + " s.");
      return false;
    }
    return true;
  }

  Status give_most_accurate() {
    const Point* best = nullptr;
    for (const Point& point : choice_.tried)
      if (!(point.setting == choice_.present.setting) && point.largest_position_error && point.cost &&
          (!best || *point.largest_position_error < *best->largest_position_error))
        best = &point;
    if (!best)
      return Error{"choose", "everything that was tried blew up", "a stabler method, a shorter time"};
    choice_.chosen = *best;
    const auto errors =
        measure_largest_errors(scene_, truth_, {choice_.chosen.setting}, trials_, control_.stop);
    if (!errors) return errors.error();
    set_error(choice_.chosen, errors->front());
    const double error = choice_.chosen.error_high.value_or(worst);
    choice_.why = "Nothing that was tried keeps " + with_significant_digits(request_.tolerance, 3) +
                  (error <= request_.tolerance ? " and holds with a margin" : "") + "; nearest came " +
                  text(choice_.chosen.setting) + " with an error of " + error_text(choice_.chosen) + ".";
    return let_present_take_part();
  }

  Spread ratio_to_runner_up() const { return ratio(runner_up_times_, chosen_times_); }

  /// Of two settings' times, round by round.
  static Spread ratio(const std::vector<double>& times, const std::vector<double>& over) {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < std::min(times.size(), over.size()); ++round)
      ratios.push_back(times[round] / over[round]);
    return spread_of(std::move(ratios), 0.01);
  }

  const scene::Scene& scene_;
  const ChooseRequest& request_;
  const Control<Choice>& control_;
  Choice choice_;
  Truth truth_;
  TrialRunner trials_;
  std::optional<StepSearch> search_;
  std::optional<WholeTime> whole_time_;  // where the horizon is earlier than the time that was asked for
  bool for_margin_ = false;              // of the chosen candidate
  // [round] [ms per simulated second]
  std::vector<double> chosen_times_, runner_up_times_, present_times_;
};

}  // namespace

Result<Choice> choose(const scene::Scene& scene, const ChooseRequest& request,
                      const Control<Choice>& control) {
  if (!(request.tolerance > 0.0 && request.tolerance <= 1.0))
    return Error{"tolerance", with_significant_digits(request.tolerance, 3),
                 "above 0, at most 1: a share of the cloth's size"};
  return Chooser(scene, request, control).choose();
}

}  // namespace clothlab::lab
