// The world of a scene with keys, as it is at a time.
#include "server/reference/reference.h"
#include "server/scene/keys.h"

namespace clothlab::reference {

/// The world at the time asked for last, whose own slot leads back here.
struct KeyedWorld {
  explicit KeyedWorld(const World& world) : keys(world.scene), now(world) {
    scene::take_keyed(keys.scene(), now.scene);
    (void)model::take_materials(now.model, keys.scene());
  }
  scene::KeyedScene keys;
  World now;
};

namespace {

KeyedWorld& keyed_world(const World& world) {
  if (!world.keyed.made) {
    world.keyed.made = std::make_shared<KeyedWorld>(world);
    // Not an owner: it lives as long as what it is in.
    world.keyed.made->now.keyed.made = {std::shared_ptr<void>(), world.keyed.made.get()};
  }
  KeyedWorld& keyed = *world.keyed.made;
  keyed.now.scene.solver = world.scene.solver;  // whoever follows a motion chooses steps of its own
  keyed.keys.set_solver(world.scene.solver);
  return keyed;
}

}  // namespace

const World& at_time(const World& world, double t) {
  if (world.scene.keys.empty()) return world;
  KeyedWorld& keyed = keyed_world(world);
  const scene::KeyedScene::Changed changed = keyed.keys.set(t, t);
  if (changed.any()) scene::take_keyed(keyed.keys.scene(), keyed.now.scene);
  // The elements are those that the world was made with, so that this cannot fail.
  if (changed.materials) (void)model::take_materials(keyed.now.model, keyed.keys.scene());
  return keyed.now;
}

const World& at_step(const World& world, State& state, double t) {
  if (world.scene.keys.empty()) return world;
  KeyedWorld& keyed = keyed_world(world);
  const bool held = keyed.keys.hold_again(t), released = keyed.keys.let_go(t).holds;
  if (held || released) {
    state.half_dt.clear();
    state.velocity_before.clear();
    state.way = state.gain = {};
    scene::take_keyed(keyed.keys.scene(), keyed.now.scene);
    if (Result<model::Model> model = model::build(keyed.keys.scene())) {
      keyed.now.model = std::move(*model);
      keyed.now.element_colours = model::colour_elements(keyed.now.model, keyed.now.scene);
      keyed.now.vertex_colours = model::colour_vertices(keyed.now.model, keyed.now.scene);
    }
  }
  return at_time(world, t);
}

std::vector<double> between_keys(const World& world, double from, double to) {
  std::vector<double> times{from};
  for (const double time : scene::key_times(world.scene))
    if (time > times.back() && time < to) times.push_back(time);
  times.push_back(to);
  return times;
}

}  // namespace clothlab::reference
