// The passes and the parts of kernels that a scene needs, derived from the scene alone: no step runs others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "server/gl/program.h"
#include "server/scene/method.h"
#include "server/scene/solid.h"
#include "server/sim/element_lists.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

/// Number of threads in a work group and of vertices in a slice of the element lists. Among 32 to 256, 128
/// was the fastest or nearly so for cloths from 25x25 to 256x256 on llvmpipe.
inline constexpr int group_size = 128;

/// Number of work groups for a kernel with one thread per vertex.
constexpr std::uint32_t vertex_groups(std::uint32_t vertex_count) {
  return (vertex_count + group_size - 1) / group_size;
}

/// At most so many work groups' results are put together by each thread alone, without a barrier.
inline constexpr std::uint32_t few_groups = 16;

/// Colliders in a row, as the kernels meet them: kind after kind, within a kind in the scene's order.
struct SolidRun {
  std::size_t kind = 0;  ///< scene::Shape's index
  bool moves = false;    ///< true if each of them has a motion, false if none has
  int count = 0;
  bool operator==(const SolidRun&) const = default;
};

/// The properties of a scene for which the step kernels are compiled. Scenes with equal plans run the same
/// kernels.
struct Plan {
  scene::Method method = scene::Method::symplectic_euler;
  LawSet laws{};                                         ///< the laws of which the scene has elements
  bool structural = false, shear = false, bend = false;  ///< true if any cloth has such springs
  bool pins = false;
  int moving = 0;                ///< distinct motions of pins and colliders, null left out
  std::vector<SolidRun> solids;  ///< in runs as long as possible
  int bodies = 0;                ///< colliders that are bodies of triangles
  int cloths_apart = 0;          ///< number of cloths if each is kept from solids by its own distance; else 0
  bool self_collision = false;   ///< between vertices
  bool surfaces = false;         ///< between surfaces of cloths
  bool wind = false;
  std::uint32_t neighbour_slots = 64;  ///< of each neighbour list; more are made if a list needs them
  bool limits_springs = false;         ///< true if any cloth with springs has a strain limit
  bool limits_sheets = false;          ///< the same of finite elements
  int most_sweeps = 0;                 ///< 16, 64, 256, ...: at least the iterations of PBD, XPBD or VBD
  /// Number of a step's rows in the pose table after the row of its start: the step's end and, before it, its
  /// middle if the method uses poses there.
  int pose_rows() const { return scene::facts(method).needs_midpoint_poses ? 2 : 1; }
  bool surface_contact() const { return surfaces || bodies > 0; }
  /// Contact between surfaces is a term of the step's problem, which the method solves.
  bool contact_term() const { return surface_contact() && scene::solves(method); }
  bool strain_limit() const { return limits_springs || limits_sheets; }
  int solid_count() const {
    return std::accumulate(solids.begin(), solids.end(), 0,
                           [](int sum, const SolidRun& run) { return sum + run.count; });
  }
  bool operator==(const Plan&) const = default;
};

Plan plan(const scene::Scene& scene);

/// The defines with which the step kernels are compiled for a plan.
gl::Defines step_defines(const Plan& plan);

/// See Simulation::parts.
std::vector<Simulation::Part> parts(const Plan& plan);

/// The motions of pins and colliders, each once, in order of appearance; null motions are left out.
std::vector<scene::Motion> moving_motions(const scene::Scene& scene);

}  // namespace clothlab::sim
