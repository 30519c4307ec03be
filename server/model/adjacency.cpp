#include "server/model/adjacency.h"

#include "server/base/pieces.h"

#include <algorithm>

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// Lists for each vertex the items that have it as a corner; `corners(item)` gives an item's vertices.
template <class Items, class Corners>
Adjacency adjacency(std::size_t vertex_count, const Items& items, Corners corners) {
  Adjacency result;
  result.offsets.assign(vertex_count + 1, 0);
  for (const auto& item : items)
    for (const Index vertex : corners(item)) ++result.offsets[vertex + 1];
  for (std::size_t i = 0; i < vertex_count; ++i) result.offsets[i + 1] += result.offsets[i];
  result.items.resize(result.offsets.back());
  std::vector<Index> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < items.size(); ++i)
    for (const Index vertex : corners(items[i])) result.items[next[vertex]++] = static_cast<Index>(i);
  return result;
}

/// Lists for each vertex the element corners at it, as in Batch::at_vertex.
template <class Law>
Adjacency corners_at(std::size_t vertex_count, const Batch<Law>& batch) {
  std::vector<Index> corners;
  corners.reserve(batch.size() * Element<Law>::corners);
  for (const Element<Law>& element : batch)
    corners.insert(corners.end(), element.vertices.begin(), element.vertices.end());
  return adjacency(vertex_count, corners, [](Index vertex) { return std::array{vertex}; });
}

Adjacency contact_exclusions(const Model& model) {
  Adjacency result;
  result.offsets.push_back(0);
  std::vector<Index> others;
  Pieces pieces;
  for (Index i = 0; i < model.vertex_count(); ++i) {
    pieces.next();
    others.clear();
    model.elements.each([&](const auto& batch) {
      batch.at(i, [&](const auto& element, std::size_t) {
        for (const Index vertex : element.vertices)
          if (vertex != i) others.push_back(vertex);
      });
    });
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    result.items.insert(result.items.end(), others.begin(), others.end());
    result.offsets.push_back(static_cast<Index>(result.items.size()));
  }
  return result;
}

}  // namespace

void list_neighbours(Model& model, bool contacts) {
  model.elements.each_of_all([&](auto& batch) {
    between_pieces();
    batch.at_vertex = corners_at(model.vertex_count(), batch);
  });
  if (contacts) model.contact_exclusions = contact_exclusions(model);
  model.vertex_triangles =
      adjacency(model.vertex_count(), model.triangles, [](const auto& corners) { return corners; });
}

}  // namespace clothlab::model
