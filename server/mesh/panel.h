// Meshes a panel of a sewing pattern: a flat piece within a closed outline, less holes, in triangles that are
// as near to equal sides as the outline allows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

namespace clothlab::mesh {

using glm::dvec2;

/// The most corners of a panel's outline and holes together, and vertices of its mesh.
inline constexpr std::size_t max_panel_corners = 2048, max_panel_vertices = 16384;

/// A run of the outline from one corner on to another one, in the outline's order.
struct PanelRun {
  std::size_t from = 0, to = 0;
};

struct Panel {
  std::vector<std::vector<dvec2>> rings;  ///< the outline, then holes, either way round [m]
  std::vector<PanelRun> runs;             ///< of the outline
  double edge = 0.02;                     ///< length of a mesh's edge [m]
};

struct PanelMesh {
  std::vector<dvec2> vertices;                          ///< the outline's, the holes', then those within
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< turning from the second axis to the first
  std::vector<std::vector<std::uint32_t>> runs;         ///< the vertices of each run
};

/// What is wrong with a panel.
struct PanelFault {
  std::size_t ring = 0, corner = 0;
  std::string found, allowed;
  bool of_edge = false;  ///< the length of edges is, not a ring
};

/// Meshes a panel, or says what is wrong with it. Between corners that turn by more than 30 degrees, and ends
/// of runs, the vertices of a ring are evenly spaced, so that runs of equal shape have equally many.
std::optional<PanelFault> mesh_panel(const Panel& panel, PanelMesh& mesh);

}  // namespace clothlab::mesh
