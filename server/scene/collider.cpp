#include "server/scene/sections.h"

namespace clothlab::scene {

Collider read_collider(const Reader& collider, std::size_t index) {
  collider.object({"name", "sphere", "plane", "friction", "restitution", "motion"}, {"capsule", "box"});
  Collider result;
  result.name = collider.member("name", default_name("collider", index)).name();
  if (collider.exactly_one({"sphere", "plane"}) == "plane") {
    const Reader plane = collider.member("plane");
    plane.object({"point", "normal"});
    result.shape = Plane{plane.member("point").vector(ranges::position), plane.member("normal").direction()};
  } else {
    const Reader sphere = collider.member("sphere");
    sphere.object({"center", "radius"});
    result.shape = Sphere{sphere.member("center").vector(ranges::position),
                          sphere.member("radius").number(ranges::length)};
  }
  result.friction = collider.member("friction", 0.0).number(ranges::friction);
  result.restitution = collider.member("restitution", 0.0).number(ranges::restitution);
  result.motion = read_motion(collider.member("motion", json(nullptr)));
  return result;
}

}  // namespace clothlab::scene
