#include "server/session/timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/scene/memory.h"
#include "server/sim/cost.h"

namespace clothlab::session {

std::uint32_t Timeline::interval(const scene::Scene& scene, int most_steps) {
  const double steps = std::min({static_cast<double>(most_steps), most_seconds / scene.solver.dt,
                                 replay_seconds / sim::expected_step_seconds(scene)});
  return static_cast<std::uint32_t>(std::max(1.0, std::round(steps)));
}

Timeline::Event Timeline::scene_event(std::uint64_t step, const scene::Document& document,
                                      const scene::Scene& scene) {
  Event event{step, std::make_shared<const std::string>(document.value.dump()),
              std::make_shared<const scene::Scene>(scene), document.scene.solver};
  event.bytes = sizeof event + event.document->capacity() + scene::memory_of(*event.scene);
  return event;
}

void Timeline::begin(const scene::Document& document, const scene::Scene& scene, std::uint64_t step,
                     std::vector<sim::Hand> hands) {
  events_.clear();
  bytes_ = 0;
  base_ = scene_event(step, document, scene);
  base_.hands = std::move(hands);
}

void Timeline::add_scene(std::uint64_t step, const scene::Document& document, const scene::Scene& scene,
                         bool forgets) {
  Event event = scene_event(step, document, scene);
  event.forgets = forgets;
  add(std::move(event));
}

void Timeline::add_hands(std::uint64_t step, std::vector<sim::Hand> hands) {
  const std::size_t bytes = sizeof(Event) + hands.size() * sizeof(sim::Hand);
  add({step, nullptr, nullptr, {}, std::move(hands), false, bytes});
}

/// What came within a step that has been given up now comes before it.
void Timeline::add(Event event) {
  for (auto last = events_.rbegin(); last != events_.rend() && last->step > event.step; ++last)
    last->step = event.step;
  bytes_ += event.bytes;
  events_.push_back(std::move(event));
}

void Timeline::apply(Event& to, const Event& later) {
  to.step = later.step;
  if (later.scene) {
    to.document = later.document;
    to.scene = later.scene;
    to.solver = later.solver;
    to.bytes = later.bytes;
  }
  if (later.hands) to.hands = later.hands;
}

void Timeline::forget_before(std::uint64_t step) {
  while (!events_.empty() && events_.front().step < step) {
    bytes_ -= events_.front().bytes;
    apply(base_, events_.front());
    events_.pop_front();
  }
}

void Timeline::cut_after(std::uint64_t step) {
  while (!events_.empty() && events_.back().step > step) {
    bytes_ -= events_.back().bytes;
    events_.pop_back();
  }
}

Timeline::Event Timeline::in_force(std::uint64_t step) const {
  Event force = base_;
  for (const Event& event : events_)
    if (event.step < step) apply(force, event);
  return force;
}

std::deque<Timeline::Event> Timeline::from(std::uint64_t step) const {
  std::deque<Event> later;
  for (const Event& event : events_)
    if (event.step >= step) later.push_back(event);
  return later;
}

}  // namespace clothlab::session
