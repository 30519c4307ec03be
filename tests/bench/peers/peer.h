// One cloth of a scene of ours as another program needs it: springs, pins and all that acts on it.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

namespace clothlab::peers {

using glm::dvec3;

struct Spring {
  int a = 0, b = 0;
  bool bends = false;  ///< to a second neighbour
};

/// A sphere, or a plane if it has no radius.
struct Collider {
  double radius = 0.0, friction = 0.0;
  dvec3 place{0.0};             ///< the sphere's center, or a point of the plane [m]
  dvec3 normal{0.0, 1.0, 0.0};  ///< of the plane, of length 1
};

struct Scene {
  std::vector<dvec3> vertices;  ///< at rest and at the start [m]
  std::vector<std::array<int, 3>> triangles;
  std::vector<Spring> springs;
  std::vector<int> held, turned;  ///< vertices that do not move, and those that turn
  dvec3 axis{0.0}, center{0.0};   ///< of the turn; the axis is of length 1
  double turn = 0.0;              ///< [radians/s]
  /// Of the springs, over the mass of a vertex [1/s^2], [1/s^2], [1/s]: a vertex weighs 1 for Bullet, whose
  /// solver stops at a residual that does not know the unit. The motion is the same.
  double stiffness = 0.0, bend = 0.0, damping = 0.0;
  double thickness = 0.0, friction = 0.0;  ///< of the cloth against itself [m]; 0: it does not meet itself
  std::vector<Collider> colliders;
  dvec3 gravity{0.0};
  double air_drag = 0.0, dt = 0.0;  ///< [1/s], [s]
  int steps = 0, steps_a_sample = 1;
  int sweeps = 10;        ///< over the links of a classic body in a step
  bool implicit = false;  ///< the elastic forces of a deformable body
};

/// The scene of a file that tests/bench/peers.mjs or peer_accuracy.mjs wrote; throws what nlohmann::json
/// throws.
Scene load(const std::string& path);

/// Where vertex `i` of `turned` is at `time` [m].
dvec3 turned_at(const Scene& scene, int i, double time);

/// A world of another program with the scene's cloth in it.
class World {
 public:
  virtual ~World() = default;
  /// Goes on by dt, until `time` is over; vertices that turn end where they are then.
  virtual void step(double time) = 0;
  virtual std::vector<dvec3> positions() const = 0;
};

std::unique_ptr<World> classic(const Scene& scene);
std::unique_ptr<World> deformable(const Scene& scene);

}  // namespace clothlab::peers
