// Pairs of a vertex and a triangle, or of two edges, whose triangles are near each other: what contact
// between surfaces keeps apart. For the host, in double precision; shares nothing with the GPU's search.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <vector>

#include "server/base/pieces.h"
#include "server/model/box_tree.h"
#include "server/model/crossings.h"

namespace clothlab::model {

/// Calls `visit(edges, corners)` for each pair of parts of two triangles that share no vertex, one of them at
/// most of a body, if the box of one triangle, widened by `reach` of it [m], meets that of the other: a
/// vertex (corners[0]) and a triangle, or, if `edges`, an edge (corners[0], corners[1]) and another one. Ends
/// early once `visit` returns false. `x`: as for find_crossings. A pair may come more than once.
template <class Reach, class Visit>
void each_near_pair(const Surfaces& surfaces, const std::vector<dvec3>& x, const Reach& reach,
                    const Visit& visit) {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<Bounds> boxes;
  for (const auto& [a, b, c] : surfaces.triangles)
    boxes.push_back({glm::min(x[a], glm::min(x[b], x[c])), glm::max(x[a], glm::max(x[b], x[c]))});
  const BoxTree tree(boxes);
  const auto apart = [&](const Triangle& one, const Triangle& other) {
    const bool body = one[0] >= surfaces.first_body_vertex,
               other_body = other[0] >= surfaces.first_body_vertex;
    if ((body && other_body) || (!surfaces.among_cloths && !body && !other_body)) return false;
    return std::none_of(one.begin(), one.end(), [&](std::uint32_t corner) {
      return std::find(other.begin(), other.end(), corner) != other.end();
    });
  };
  std::vector<std::uint32_t> others;
  Pieces pieces;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    pieces.next();
    const double wider = reach(boxes[i]);
    others.clear();
    tree.overlapping({boxes[i].low - wider, boxes[i].high + wider}, others);
    for (const std::uint32_t number : others) {
      const Triangle &one = surfaces.triangles[i], &other = surfaces.triangles[number];
      if (!apart(one, other)) continue;
      for (const std::uint32_t corner : one)
        if (!visit(false, {corner, other[0], other[1], other[2]})) return;
      if (!(one < other)) continue;  // two edges once
      for (std::size_t m = 0; m < 3; ++m)
        for (std::size_t n = 0; n < 3; ++n)
          if (!visit(true, {one[m], one[(m + 1) % 3], other[n], other[(n + 1) % 3]})) return;
    }
  }
}

}  // namespace clothlab::model
