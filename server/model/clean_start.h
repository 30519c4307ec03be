// Crossings in words that a user understands, and the refusal of scenes that start with some where contact
// only keeps apart what is apart: between surfaces of cloth, and between cloth and bodies of triangles.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/crossings.h"

namespace clothlab::model {

/// E.g. `edge 3-4 of /cloths/0 ("left") meets triangle 7-8-12 of /cloths/1 ("right") at (0.1, 1, 0)`.
/// Vertices have the numbers that the document gives them: its own, or those of the mesh's file.
std::string in_words(const Crossing& crossing, const Model& model, const scene::Scene& scene);

/// E.g. `vertex 3 of /cloths/0 ("left")`. Vertices count from those of cloths on, bodies' behind them.
std::string place_in_words(std::uint32_t vertex, const Model& model, const scene::Scene& scene);

/// An error if the scene's kind of self-collision needs a start without crossings and it has some, in the
/// positions as the GPU gets them: float32. It points at the kind, names the first pairs and their number,
/// and says what helps. Its facts have more of the pairs, with their places. Whatever the kind, an error that
/// points at a body if cloth starts through it (with such facts) or inside it.
Status check_start(const Model& model, const scene::Scene& scene);

/// The same of a running scene that is to get this kind, with its vertices at `position` [vertex_count] [m].
Status check_present(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& position);

}  // namespace clothlab::model
