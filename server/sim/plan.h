// Which passes a scene needs, and nothing else: derived from the scene alone (principle 2 of the design).
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "server/gl/program.h"
#include "server/scene/method.h"
#include "server/scene/solid.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

/// Threads in a work group and vertices in a slice of the element lists. Of 32 to 256, 128 was best or near
/// it for cloths from 25x25 to 256x256 on llvmpipe.
inline constexpr int group_size = 128;

/// Work groups of a kernel with one thread a vertex.
constexpr std::uint32_t vertex_groups(std::uint32_t vertex_count) {
  return (vertex_count + group_size - 1) / group_size;
}

/// What the step kernel is specialised for. Two scenes with equal plans run the same kernels.
struct Plan {
  scene::Method method = scene::Method::symplectic_euler;
  bool structural = false, shear = false, bend = false;  ///< in any cloth
  bool springs() const { return structural || shear || bend; }
  bool pins = false;
  int moving = 0;                                ///< distinct motions of pins and colliders that are not null
  std::array<int, scene::shape_kinds> solids{};  ///< colliders of each kind of shape
  bool self_collision = false;
  std::uint32_t neighbour_slots = 64;  ///< of each vertex, for self-collision; not the scene's to say
  bool strain_limit = false;           ///< of any cloth
  int most_sweeps = 0;                 ///< at least the iterations of PBD, XPBD or VBD: 16, 64, 256, ...
  /// Rows that a step has in the table of poses after the one at its start: its end, and before that its
  /// middle if the method looks at it.
  int pose_rows() const { return scene::facts(method).looks_at_the_middle ? 2 : 1; }
  int solid_count() const { return std::accumulate(solids.begin(), solids.end(), 0); }
  bool operator==(const Plan&) const = default;
};

Plan plan(const scene::Scene& scene);

/// The defines that specialise the step kernel.
gl::Defines step_defines(const Plan& plan);

/// See Simulation::parts.
std::vector<Simulation::Part> parts(const Plan& plan);

/// The motions of pins and colliders that are not null, each once, in order of appearance.
std::vector<scene::Motion> moving_motions(const scene::Scene& scene);

}  // namespace clothlab::sim
