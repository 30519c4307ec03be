// The method "auto" in a session: the settings to step with until the lab has chosen, when the lab has to
// choose, and whether its choice still holds. This class only decides: it changes no simulation.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "server/lab/measure/choice.h"
#include "server/scene/document.h"

namespace clothlab::session {

using nlohmann::json;

class Automatic {
 public:
  using Clock = std::chrono::steady_clock;

  /// The document's scene with the settings to step it with: the lab's choice if that covers the document,
  /// else stable settings, and a choice becomes due after `quiet`. A method other than "auto" stays as it is.
  /// Error: the scene's model cannot be built.
  Result<scene::Scene> settle(const scene::Document& document, Clock::time_point now);

  /// True once for each choice that is due: `quiet` after the last change, so that a slider that is being
  /// moved causes only one choice.
  bool wants_choice(Clock::time_point now);

  /// Takes in the lab's choice, or its error, for the document that the lab measured.
  void take(const scene::Document& measured, const Result<lab::Choice>& choice);

  /// {state: "measuring" | "chosen" | "failed", ...} for sim.status, null if the method is not "auto".
  json facts() const;

  static constexpr std::chrono::milliseconds quiet{700};

 private:
  struct Choice {
    json measured;  ///< the document that the lab measured
    std::optional<lab::Setting> setting;
    json facts;
  };
  std::optional<Choice> choice_;
  std::optional<lab::Setting> in_use_;  ///< none: the method is not "auto"
  bool covered_ = false;                ///< `choice_` holds for the present document
  std::optional<Clock::time_point> due_;
};

}  // namespace clothlab::session
