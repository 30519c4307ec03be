// What both of Bullet's soft bodies are made of: the cloth's nodes, links and faces, and what it falls on.
#pragma once

#include <BulletSoftBody/btSoftBody.h>
#include <btBulletDynamicsCommon.h>

#include "tests/bench/peers/peer.h"

namespace clothlab::peers {

inline btVector3 to_bullet(const dvec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

/// Bullet tabulates the distance to a body and interpolates: so far apart [m]. Of a ball of 15 cm that is
/// wrong by a fifth of a millimetre at most.
inline constexpr btScalar distance_spacing = 0.015f;

/// Margins of half the thickness: two layers are kept the thickness apart. All vertices are free.
std::unique_ptr<btSoftBody> make_cloth(btSoftBodyWorldInfo& info, const Scene& scene);

/// Gives what is held, and what turns, the mass `of`; 0: no force moves it.
void set_pinned_mass(btSoftBody& cloth, const Scene& scene, double of);

/// Sends what is held, and what turns, to where it is at `time`, which is a step ahead.
void aim(btSoftBody& cloth, const Scene& scene, double time);
/// Puts it there, whatever contact did to it.
void place(btSoftBody& cloth, const Scene& scene, double time);

std::vector<dvec3> positions_of(const btSoftBody& cloth);

struct Bodies {
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
};

/// Spheres and planes. Bullet multiplies a body's friction by the cloth's, so it is divided by that here.
Bodies add_colliders(btDynamicsWorld& world, const Scene& scene, double cloth_friction);

}  // namespace clothlab::peers
