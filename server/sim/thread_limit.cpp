#include "server/sim/thread_limit.h"

#include <algorithm>

#include "shaders/slots.h"

namespace clothlab::sim {

namespace {

using Index = std::uint32_t;

/// For each vertex the corners of the limited triangles at it, as triangle * 3 + corner.
model::Adjacency limited_corners(const model::Model& model, const std::vector<Index>& triangles) {
  const model::Batch<elements::Membrane>& membranes = model.elements.of<elements::Membrane>();
  model::Adjacency result;
  result.offsets.assign(model.vertex_count() + 1, 0);
  for (const Index triangle : triangles)
    for (const Index vertex : membranes[triangle].vertices) ++result.offsets[vertex + 1];
  for (std::size_t i = 0; i < model.vertex_count(); ++i) result.offsets[i + 1] += result.offsets[i];
  result.items.resize(result.offsets.back());
  std::vector<Index> next(result.offsets.begin(), result.offsets.end() - 1);
  for (Index t = 0; t < triangles.size(); ++t)
    for (Index corner = 0; corner < 3; ++corner)
      result.items[next[membranes[triangles[t]].vertices[corner]]++] = 3 * t + corner;
  return result;
}

}  // namespace

ThreadLimit::ThreadLimit(const model::Model& model, const scene::Scene& scene) {
  const model::Batch<elements::Membrane>& membranes = model.elements.of<elements::Membrane>();
  for (Index i = 0; i < membranes.size(); ++i)
    if (scene.cloths[model.vertex_cloth[membranes[i].vertices[0]]].strain_limit()) triangles_.push_back(i);
  model::Adjacency corners = limited_corners(model, triangles_);
  if (corners.items.empty()) corners.items.push_back(0);
  first_corner_ = {gl::Buffer(corners.offsets), GL_R32UI};
  corners_ = {gl::Buffer(corners.items), GL_R32UI};
  pulls_ = gl::Buffer(corners.items.size() * 2 * sizeof(float));
  set_parameters(model);
  restart();
}

/// The relaxation factor of a triangle's pulls is 1.6 over the number of triangles at its fullest free
/// corner: see `relaxation` in strain_limit.cpp. There the threads of one direction are parallel, or nearly.
void ThreadLimit::set_parameters(const model::Model& model) {
  const model::Batch<elements::Membrane>& membranes = model.elements.of<elements::Membrane>();
  std::vector<Words> records;
  records.reserve(2 * triangles_.size() + 1);
  for (const Index triangle : triangles_) {
    const auto& [vertices, law] = membranes[triangle];
    Index most = 1;
    for (const Index vertex : vertices)
      if (model.pin_motion[vertex] == model::not_pinned)
        most = std::max(most, membranes.at_vertex.offsets[vertex + 1] - membranes.at_vertex.offsets[vertex]);
    records.push_back({vertices[0], vertices[1], vertices[2], word(1.6 / most)});
    // F falls with the corner's value less the others': the share of another corner is the law's number.
    records.push_back(
        {word(law.first_warp), word(law.first_weft), word(law.second_warp), word(law.second_weft)});
  }
  if (records.empty()) records.push_back({});
  records_ = {gl::Buffer(records), GL_RGBA32UI};
}

void ThreadLimit::bind() const {
  first_corner_.bind(unit_first_corner);
  corners_.bind(unit_corners);
  records_.bind(unit_limited_triangles);
  pulls_.bind_storage(slot_thread_pulls);
}

}  // namespace clothlab::sim
