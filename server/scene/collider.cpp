#include "server/scene/sections.h"
#include "server/scene/solid.h"

namespace clothlab::scene {

Collider read_collider(const Reader& collider, std::size_t index, const Assets* assets) {
  Words keys{"name"};
  keys.insert(keys.end(), shape_names().begin(), shape_names().end());
  keys.insert(keys.end(), {"transform", "friction", "restitution", "motion"});
  collider.object(keys);
  Collider result;
  result.name = collider.member("name", default_name("collider", index)).name();
  result.shape = read_shape(collider, assets);
  result.friction = collider.member("friction", 0.0).number(ranges::friction);
  result.restitution = collider.member("restitution", 0.0).number(ranges::restitution);
  result.motion = read_motion(collider.member("motion", json(nullptr)));
  return result;
}

}  // namespace clothlab::scene
