// Reads a panel: a flat piece of cloth by its outline, which server/mesh/panel.h meshes.
#include "server/mesh/panel.h"

#include "server/scene/sections.h"

namespace clothlab::scene {

namespace {

std::vector<glm::dvec2> read_ring(const Reader& ring) {
  std::vector<glm::dvec2> corners(ring.array(3, mesh::max_panel_corners));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Reader corner = ring.element(i);
    if (corner.array(2, 2) != 2) break;
    corners[i] = {corner.element(0).number(ranges::position), corner.element(1).number(ranges::position)};
  }
  return corners;
}

mesh::PanelRun read_run(const Reader& run, std::size_t corners) {
  if (run.array(2, 2) != 2) return {};
  const Range index{0, static_cast<double>(corners) - 1, "corner of the outline"};
  const mesh::PanelRun result{static_cast<std::size_t>(run.element(0).integer(index)),
                              static_cast<std::size_t>(run.element(1).integer(index))};
  if (result.from == result.to) run.fail("two different corners: from the first on to the second");
  return result;
}

}  // namespace

TriangleMesh read_panel(const Reader& panel) {
  panel.object({"outline", "holes", "edge", "edges"});
  const Reader outline = panel.member("outline"), holes = panel.member("holes", json::array()),
               edge = panel.member("edge"), edges = panel.member("edges", json::object());
  mesh::Panel read;
  read.rings.push_back(read_ring(outline));
  read.rings.resize(1 + holes.array(0, max_panel_holes));
  for (std::size_t i = 1; i < read.rings.size(); ++i) read.rings[i] = read_ring(holes.element(i - 1));
  read.edge = edge.number(ranges::length);
  const Words names = edges.keys(max_panel_edges);
  if (panel.failed()) return {};
  for (const std::string& name : names)
    read.runs.push_back(read_run(edges.member(name), read.rings[0].size()));
  if (panel.failed()) return {};
  mesh::PanelMesh made;
  if (const auto fault = mesh::mesh_panel(read, made)) {
    const Reader ring = fault->ring == 0 ? outline : holes.element(fault->ring - 1);
    (fault->of_edge ? edge : ring.element(fault->corner)).fail(fault->found, fault->allowed);
    return {};
  }
  TriangleMesh result;
  for (const glm::dvec2& place : made.vertices) result.vertices.emplace_back(place.x, 0.0, place.y);
  result.triangles = std::move(made.triangles);
  for (std::size_t i = 0; i < names.size(); ++i) result.runs.push_back({names[i], std::move(made.runs[i])});
  return result;
}

}  // namespace clothlab::scene
