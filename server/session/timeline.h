// What has changed a session's run besides its steps, with the step before which it did: scenes and hands.
// From a kept state (sim/kept_states.h) and what follows it here, any later step is reached again, bit for
// bit.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/document.h"
#include "server/sim/hands.h"

namespace clothlab::session {

class Timeline {
 public:
  static constexpr double most_seconds = 1;    ///< of simulated time between two kept states [s]
  static constexpr double replay_seconds = 2;  ///< that these steps may take, by an estimate [s]

  struct Event {
    std::uint64_t step = 0;  ///< it comes before this step
    /// The document's text (in memory JSON takes several times that) with the scene as it is stepped, whose
    /// solver differs from the document's where that has the method `auto`; null: only hands change.
    std::shared_ptr<const std::string> document{};
    std::shared_ptr<const scene::Scene> scene{};
    scene::Solver solver{};  ///< the document's
    std::optional<std::vector<sim::Hand>> hands{};
    bool forgets = false;  ///< the passes forget what they carry: the run went back to its last good state
    std::size_t bytes = 0;
  };

  /// Steps from one kept state to the next, `most_steps` at most.
  static std::uint32_t interval(const scene::Scene& scene, int most_steps);

  void begin(const scene::Document& document, const scene::Scene& scene, std::uint64_t step,
             std::vector<sim::Hand> hands = {});
  void clear() { *this = {}; }
  void add_scene(std::uint64_t step, const scene::Document& document, const scene::Scene& scene,
                 bool forgets);
  void add_hands(std::uint64_t step, std::vector<sim::Hand> hands);
  /// What came before a step that can no longer be reached is forgotten.
  void forget_before(std::uint64_t step);
  /// What came after a step is forgotten: the run goes on from that step.
  void cut_after(std::uint64_t step);

  /// The document, scene and hands when step `step` had been reached, before what changed them there.
  Event in_force(std::uint64_t step) const;
  /// What came from `step` on.
  std::deque<Event> from(std::uint64_t step) const;
  std::size_t bytes() const { return bytes_ + base_.bytes; }

 private:
  void add(Event event);
  static Event scene_event(std::uint64_t step, const scene::Document& document, const scene::Scene& scene);
  static void apply(Event& to, const Event& later);

  Event base_;                ///< what is in force at the beginning
  std::deque<Event> events_;  ///< by step
  std::size_t bytes_ = 0;     ///< of events_
};

}  // namespace clothlab::session
