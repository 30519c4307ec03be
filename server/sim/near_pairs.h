// The pairs near each other that contact keeps apart: what its passes have listed on the GPU, read back, and
// vertices near solids. For who wants to look; no step reads this.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/sim/simulation.h"

namespace clothlab::sim {

struct Kernels;

struct NearPair {
  enum class Kind : std::uint8_t { vertex_vertex, vertex_triangle, edge_edge, vertex_solid };
  static constexpr std::uint32_t none = 0xffffffffu;

  Kind kind = Kind::vertex_vertex;
  /// As the scene numbers them, those of bodies after those of cloths; the first part's, then the second's,
  /// then `none`. Of a solid its place in the scene's list of colliders.
  std::array<std::uint32_t, 4> vertices{none, none, none, none};
  /// Of each vertex in the nearest point of its part, of which there are one or two: those of a part add up
  /// to 1.
  std::array<float, 4> shares{};
  std::array<glm::dvec3, 2> nearest{};  ///< the nearest points of both parts [m]
  double gap = 0;                       ///< their distance; less than 0 of a vertex within a solid [m]
  double keep = 0;                      ///< the distance at which contact keeps them apart [m]
};

/// Pairs are near if they are less than so many times as far apart as they are kept.
inline constexpr double near_share = 1.5;

struct NearPairs {
  /// False: the lists await the search of the next step, as after the start, a reset or another thickness.
  bool searched = true;
  /// By gap over keep, the least first. All pairs that are nearer than `keep` are there; of others those that
  /// the last search listed.
  std::vector<NearPair> pairs;
};

/// `state`: the present one, at `time` [s]. Waits for the GPU.
NearPairs near_pairs(const Kernels& kernels, const scene::Scene& scene, const State& state, double time);

}  // namespace clothlab::sim
