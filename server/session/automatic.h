// The method "auto" in a session: what is stepped until the lab has chosen, when a choice is to be made, and
// whether it still holds. Changes nothing by itself.
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

  /// The document's scene with the settings that it is stepped with: what was chosen where that covers the
  /// document, else what is stable, and a choice is due soon. Another method than "auto" is left as it is.
  /// Error: the scene's model cannot be built.
  Result<scene::Scene> settle(const scene::Document& document, Clock::time_point now);

  /// Once for each choice that is due: when nothing has changed for a while, as a slider would.
  bool wants_choice(Clock::time_point now);

  /// What has come of it, for the document that was measured.
  void take(const scene::Document& measured, const Result<lab::Choice>& choice);

  /// {state: "measuring" | "chosen" | "failed", ...} for sim.status, null without the method.
  json facts() const;

  static constexpr std::chrono::milliseconds quiet{700};

 private:
  struct Choice {
    json measured;  ///< the document
    std::optional<lab::Setting> setting;
    json facts;
  };
  std::optional<Choice> choice_;
  std::optional<lab::Setting> in_use_;  ///< none: another method
  bool covered_ = false;
  std::optional<Clock::time_point> due_;
};

}  // namespace clothlab::session
