// What can be known of a setting without a reference: a choice keeps it over the whole time that was asked
// for, where the reference ends earlier.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

class WholeTime {
 public:
  /// `tolerance`: of positions, a share of the cloth's size. `scene` and `truth` have to outlive it.
  WholeTime(const scene::Scene& scene, const Truth& truth, double tolerance, TrialRunner& trials,
            std::stop_token stop);

  /// What speaks against `setting` up to `truth.asked`, for the end of a sentence; empty: nothing does. Its
  /// steps must be as well solved as the tolerance asks for; it may stretch the cloth by half more than a run
  /// of BDF2 with short steps that are solved; its energy may not rise where nothing does work; and half of
  /// its step must lead the centre of the cloths to the same places. Error: GL, or cancelled.
  Result<std::string> fault(const Setting& setting);

 private:
  struct Run {
    double largest_strain = 0;
    double energy_scale = 0;           ///< the largest kinetic + elastic energy [J]
    double gained = 0;                 ///< the largest total energy less that of the start [J]
    int measured = 0;                  ///< looks with another measured step (sim::Convergence)
    double mean_error = 0;             ///< of those steps [m]
    std::vector<glm::dvec3> centre;    ///< [look] of the free vertices [m]
    std::optional<double> blew_up_at;  ///< [s]
  };
  /// `looks`: how often, evenly spread over the time. Shortens the step so that each is at the end of one.
  Result<Run> run(Setting setting, int looks);
  /// Of a step that iterations may leave [m]: errors of methods that solve add up over the steps.
  double allowed_error(const Setting& setting) const;

  const scene::Scene& scene_;
  const Truth& truth_;
  double tolerance_;
  TrialRunner& trials_;
  std::stop_token stop_;
  std::optional<Run> solved_;  ///< of BDF2, once it is needed
};

}  // namespace clothlab::lab
