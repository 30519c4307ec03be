// Bullet's classic soft body: position-based links, one after the other, ten times a step unless the scene
// says how often.
//
// Stiffness. A sweep moves a link by the share kLST of its error, whatever the step. Over all sweeps a link
// alone is to move as far as one step of implicit Euler would move it: by w / (w + 1 / (k dt^2)), w the sum
// of both inverse masses. Links know no damping and no stiffness under compression other than under tension.
//
// Self-collision. Bullet has it for clusters alone; one a triangle, here, is the finest that it offers.
// In 3.24 a world does not start it: CL_SELF is a bit of SVSmask since VF_DD is one, so that no case of
// btSoftBody::defaultCollisionHandler has both CL_SS and CL_SELF. So step() calls the same collider, where
// the world would.
#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyInternals.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <map>

#include "tests/bench/peers/bodies.h"

namespace clothlab::peers {

namespace {

/// The share of its error that a sweep takes from a link of stiffness `k`, over a vertex's mass [1/s^2].
double share(double k, double inverse_masses, const Scene& scene) {
  const double whole = inverse_masses / (inverse_masses + 1.0 / (k * scene.dt * scene.dt));
  return 1.0 - std::pow(1.0 - whole, 1.0 / scene.sweeps);
}

/// Links of a stiffness, and of as many fixed ends, share a material.
void set_stiffness(btSoftBody& cloth, const Scene& scene) {
  std::map<double, btSoftBody::Material*> materials;
  for (int i = 0; i < cloth.m_links.size(); ++i) {
    btSoftBody::Link& link = cloth.m_links[i];
    const double inverse_masses = static_cast<double>(link.m_n[0]->m_im) + link.m_n[1]->m_im;
    const double k = link.m_bbending ? scene.bend : scene.stiffness;
    if (inverse_masses == 0.0) continue;  // nothing moves it
    const double of_sweep = share(k, inverse_masses, scene);
    btSoftBody::Material*& material = materials[of_sweep];
    if (!material) {
      material = cloth.appendMaterial();
      material->m_kLST = static_cast<btScalar>(of_sweep);
    }
    link.m_material = material;
  }
}

class Classic : public World {
 public:
  explicit Classic(const Scene& scene)
      : scene_(scene), world_(&dispatcher_, &broadphase_, &solver_, &configuration_, &soft_solver_) {
    world_.setGravity(to_bullet(scene.gravity));
    btSoftBodyWorldInfo& info = world_.getWorldInfo();
    info.m_gravity = to_bullet(scene.gravity);
    info.air_density = 0;  // drag is kDP here
    info.m_sparsesdf.setDefaultVoxelsz(distance_spacing);
    info.m_sparsesdf.Reset();  // takes it over
    cloth_ = make_cloth(info, scene);
    btSoftBody::Config& settings = cloth_->m_cfg;
    settings.piterations = scene.sweeps;
    settings.collisions = btSoftBody::fCollision::SDF_RS;
    settings.kKHR = 1;  // contact with what does not move is hard, as for the deformable cloth
    settings.kDP = static_cast<btScalar>(scene.air_drag * scene.dt);
    settings.kDF = static_cast<btScalar>(scene.friction);
    // Bullet takes a mass of 1e18 for a pinned vertex of a cluster, and the cluster's inertia overflows a
    // float.
    if (scene.thickness > 0.0) {
      settings.collisions |= btSoftBody::fCollision::CL_SS;
      set_pinned_mass(*cloth_, scene, 1000);
      cloth_->generateClusters(0);
    }
    set_pinned_mass(*cloth_, scene, 0);
    set_stiffness(*cloth_, scene);
    world_.addSoftBody(cloth_.get());
    bodies_ = add_colliders(world_, scene, scene.friction);
  }

  void step(double time) override {
    aim(*cloth_, scene_, time);
    world_.stepSimulation(static_cast<btScalar>(scene_.dt), 0);
    if (scene_.thickness > 0.0) {
      btSoftColliders::CollideCL_SS self;
      self.ProcessSoftSoft(cloth_.get(), cloth_.get());
    }
    place(*cloth_, scene_, time);
  }

  std::vector<dvec3> positions() const override { return positions_of(*cloth_); }

 private:
  const Scene& scene_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDefaultSoftBodySolver soft_solver_;
  std::unique_ptr<btSoftBody> cloth_;
  Bodies bodies_;
  btSoftRigidDynamicsWorld world_;  // goes first: it knows the bodies
};

}  // namespace

std::unique_ptr<World> classic(const Scene& scene) {
  return std::make_unique<Classic>(scene);
}

}  // namespace clothlab::peers
