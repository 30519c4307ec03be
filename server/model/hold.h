// A hand's hold on a cloth: which vertices it pulls and how hard. No GL, no time.
//
// The spring from a hand to the cloth is as stiff as it must be to hold the whole cloth up with little sag,
// and pulls with at most a few times what the cloth weighs: strong enough to lift, too weak to tear. It is
// spread over the vertices near the held one, so that no single vertex is pulled far out of the cloth. Its
// stiffness never lowers a step limit: shaders/hands/hold.comp.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Hold {
  struct Vertex {
    std::uint32_t vertex = 0;  ///< in the order of the model that the hold was made for
    double stiffness = 0;      ///< [N/m]
    double damping = 0;        ///< [N s/m], of the vertex's own vibration on the spring: critical
    dvec3 offset{0.0};         ///< of its place from the held vertex's when the hold began [m]
  };
  std::vector<Vertex> vertices;  ///< the held one first
  double reach = 0;              ///< the distance from hand to cloth beyond which the pull grows no more [m]
  double force = 0;              ///< the pull at that distance, of all vertices together [N]
};

/// A hold on the vertex, which must not be pinned, and on the free ones near it. `position` [vertex_count]
/// [m]: where they are now.
Hold hold_on(const Model& model, const scene::Scene& scene, std::uint32_t vertex,
             const std::vector<glm::vec3>& position);

}  // namespace clothlab::model
