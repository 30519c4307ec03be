// The two sides that are tested of every method, the double-precision reference and the GPU's float32, with
// one interface.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "server/reference/reference.h"
#include "server/scene/method.h"
#include "server/sim/colliders.h"
#include "tests/scenes.h"

namespace clothlab::test {

enum class Side { reference, gpu };
inline constexpr std::array sides{Side::reference, Side::gpu};
inline const char* name(Side side) {
  return side == Side::gpu ? "GPU, float32" : "reference, float64";
}

/// A scene being stepped on one side, from rest. The GPU's side needs a context that is current on this
/// thread.
class Stepped {
 public:
  Stepped(Side side, const scene::Scene& scene)
      : world_(world_of(scene)), state_(reference::at_rest(world_)) {
    if (side == Side::gpu) simulation_ = simulation(scene);
  }

  void step(int count) {
    if (simulation_) return simulation_->step(static_cast<std::uint32_t>(count));
    for (int n = 0; n < count; ++n) reference::step(world_, state_);
  }

  /// The present state; the GPU's is read back.
  reference::State state() {
    if (!simulation_) return state_;
    const sim::State found = simulation_->read_state();
    reference::State result;
    result.position.assign(found.position.begin(), found.position.end());
    result.velocity.assign(found.velocity.begin(), found.velocity.end());
    return result;
  }

  /// Energy of the present state, summed in double precision on either side [J].
  reference::Energy energy() { return reference::energy(world_, state()); }

  /// Steps of the GPU's side that have ended, and were counted, with a strain limit not met.
  std::uint64_t beyond_limit() const {
    return simulation_ ? simulation_->strain_limit_work().unconverged : 0;
  }

  /// Goes on from the present state with a changed scene of the same vertices.
  void change(const scene::Scene& scene) {
    world_ = world_of(scene);
    if (!simulation_) {
      // Verlet and BDF2 start anew from the present velocity.
      state_.half_dt.clear();
      state_.way = state_.gain = {};
      return;
    }
    const auto changed = simulation_->change(scene);
    INFO((changed ? "" : changed.error().text()));
    REQUIRE(changed);
  }

  /// Goes back to rest, with another dt [s].
  void restart(double dt) {
    scene::Scene scene = world_.scene;
    scene.solver.dt = dt;
    change(scene);
    state_ = reference::at_rest(world_);
    if (simulation_) simulation_->reset();
  }

  const reference::World& world() const { return world_; }

 private:
  static reference::World world_of(const scene::Scene& scene) {
    Result<model::Model> model = model::build(scene);
    REQUIRE(model);
    return *reference::make_world(scene, sim::contact_margins(scene, *model));
  }

  reference::World world_;
  reference::State state_;
  std::unique_ptr<sim::Simulation> simulation_;
};

}  // namespace clothlab::test
