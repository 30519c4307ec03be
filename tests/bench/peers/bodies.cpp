#include "tests/bench/peers/bodies.h"

namespace clothlab::peers {

std::unique_ptr<btSoftBody> make_cloth(btSoftBodyWorldInfo& info, const Scene& scene) {
  std::vector<btVector3> places;
  const std::vector<btScalar> masses(scene.vertices.size(), 1);
  for (const dvec3& vertex : scene.vertices) places.push_back(to_bullet(vertex));
  auto cloth =
      std::make_unique<btSoftBody>(&info, static_cast<int>(places.size()), places.data(), masses.data());
  cloth->getCollisionShape()->setMargin(static_cast<btScalar>(scene.thickness / 2));
  for (const Spring& spring : scene.springs) {
    cloth->appendLink(spring.a, spring.b);
    cloth->m_links[cloth->m_links.size() - 1].m_bbending = spring.bends ? 1 : 0;
  }
  // Where nothing is met, the search over faces would be half of a deformable body's time.
  if (scene.thickness > 0.0 || !scene.colliders.empty())
    for (const auto& [a, b, c] : scene.triangles) cloth->appendFace(a, b, c);
  return cloth;
}

void set_pinned_mass(btSoftBody& cloth, const Scene& scene, double of) {
  for (const auto* pinned : {&scene.held, &scene.turned})
    for (const int i : *pinned) cloth.setMass(i, static_cast<btScalar>(of));
}

void aim(btSoftBody& cloth, const Scene& scene, double time) {
  for (const int i : scene.held) cloth.m_nodes[i].m_v = cloth.m_nodes[i].m_vn = btVector3(0, 0, 0);
  for (const int i : scene.turned) {
    btSoftBody::Node& node = cloth.m_nodes[i];
    node.m_v = node.m_vn =
        (to_bullet(turned_at(scene, i, time)) - node.m_x) / static_cast<btScalar>(scene.dt);
  }
}

void place(btSoftBody& cloth, const Scene& scene, double time) {
  for (const int i : scene.held)
    cloth.m_nodes[i].m_x = cloth.m_nodes[i].m_q = to_bullet(scene.vertices[static_cast<std::size_t>(i)]);
  for (const int i : scene.turned)
    cloth.m_nodes[i].m_x = cloth.m_nodes[i].m_q = to_bullet(turned_at(scene, i, time));
}

std::vector<dvec3> positions_of(const btSoftBody& cloth) {
  std::vector<dvec3> positions;
  for (int i = 0; i < cloth.m_nodes.size(); ++i) {
    const btVector3& x = cloth.m_nodes[i].m_x;
    positions.emplace_back(x.x(), x.y(), x.z());
  }
  return positions;
}

Bodies add_colliders(btDynamicsWorld& world, const Scene& scene, double cloth_friction) {
  Bodies made;
  for (const Collider& collider : scene.colliders) {
    btTransform at(btQuaternion::getIdentity(), to_bullet(collider.place));
    if (collider.radius > 0.0) {
      made.shapes.push_back(std::make_unique<btSphereShape>(static_cast<btScalar>(collider.radius)));
    } else {
      // A cloth falls through Bullet's planes: it asks convex bodies alone for their distance.
      const btScalar half = 10;
      made.shapes.push_back(std::make_unique<btBoxShape>(btVector3(half, half, half)));
      const btVector3 normal = to_bullet(collider.normal);
      at.setRotation(shortestArcQuat(btVector3(0, 1, 0), normal));
      at.setOrigin(at.getOrigin() - half * normal);
    }
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, made.shapes.back().get());
    info.m_startWorldTransform = at;
    info.m_friction = static_cast<btScalar>(collider.friction / cloth_friction);
    made.bodies.push_back(std::make_unique<btRigidBody>(info));
    world.addRigidBody(made.bodies.back().get());
  }
  return made;
}

}  // namespace clothlab::peers
