#include "server/model/colouring.h"
#include "server/base/pieces.h"

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace clothlab::model {

namespace {

using Index = std::uint32_t;
constexpr Index uncoloured = ~Index{0};

struct GridPlace {
  Index column = 0, row = 0;
};

GridPlace place(const scene::Grid& grid, Index vertex) {
  const auto columns = static_cast<Index>(grid.columns);
  return {vertex % columns, vertex / columns};
}

/// For laws without a closed form: the element stays uncoloured.
template <class Law>
Index grid_colour(const scene::Grid&, Index, const Element<Law>&) {
  return uncoloured;
}

/// A grid spring's colour, in [0, 12): two for each of six pairs of direction and length. A spring's ends are
/// one or two vertices apart in its direction; its distance from the grid's edge in that length, even or odd,
/// picks the colour.
Index grid_colour(const scene::Grid& grid, Index first_vertex, const Spring& spring) {
  const GridPlace a = place(grid, spring.vertices[0] - first_vertex),
                  b = place(grid, spring.vertices[1] - first_vertex);
  const Index across = b.column > a.column ? b.column - a.column : a.column - b.column, down = b.row - a.row;
  const Index left = std::min(a.column, b.column);
  if (down == 0) return (across == 2 ? 8 : 0) + left / across % 2;
  if (across == 0) return (down == 2 ? 10 : 2) + a.row / down % 2;
  return (b.column > a.column ? 4 : 6) + a.row % 2;
}

/// The colour with fewest members among those not `taken`, or a new colour if all are taken. Counts one more
/// member for it.
Index least_crowded(const std::vector<char>& taken, std::vector<Index>& members) {
  Index best = uncoloured;
  for (Index colour = 0; colour < members.size(); ++colour)
    if (!taken[colour] && (best == uncoloured || members[colour] < members[best])) best = colour;
  if (best == uncoloured) {
    best = static_cast<Index>(members.size());
    members.push_back(0);
  }
  ++members[best];
  return best;
}

/// Colours the items of `queue` in order; `neighbours(item, visit)` calls visit(other) for each other item
/// that must have a different colour.
template <class Neighbours>
void colour_greedily(const std::vector<Index>& queue, Neighbours neighbours, std::vector<Index>& colour) {
  std::vector<Index> members;
  std::vector<char> taken;
  Pieces pieces;
  for (const Index item : queue) {
    pieces.next();
    taken.assign(members.size() + 1, 0);
    neighbours(item, [&](Index other) {
      if (colour[other] != uncoloured) taken[colour[other]] = 1;
    });
    colour[item] = least_crowded(taken, members);
  }
}

/// Groups the items by colour; colours without items are left out.
Colouring group(const std::vector<Index>& colour) {
  const Index count = colour.empty() ? 0 : *std::max_element(colour.begin(), colour.end()) + 1;
  between_pieces();
  std::vector<std::vector<Index>> groups(count);
  for (Index item = 0; item < colour.size(); ++item) groups[colour[item]].push_back(item);
  Colouring result;
  result.offsets.push_back(0);
  for (const std::vector<Index>& members : groups) {
    if (members.empty()) continue;
    result.order.insert(result.order.end(), members.begin(), members.end());
    result.offsets.push_back(static_cast<Index>(result.order.size()));
  }
  return result;
}

const scene::Grid* grid_of(const scene::Scene& scene, Index cloth) {
  return std::get_if<scene::Grid>(&scene.cloths[cloth].mesh);
}

template <class Law>
Colouring colour_batch(const Model& model, const scene::Scene& scene, const Batch<Law>& batch) {
  constexpr auto corners = static_cast<Index>(Element<Law>::corners);
  std::vector<Index> colour(batch.size(), uncoloured), queue;
  Pieces pieces;
  for (Index i = 0; i < batch.size(); ++i) {
    pieces.next();
    const Index cloth = model.vertex_cloth[batch[i].vertices[0]];
    if (const scene::Grid* grid = grid_of(scene, cloth))
      colour[i] = grid_colour(*grid, model.cloths[cloth].first_vertex, batch[i]);
    if (colour[i] == uncoloured) queue.push_back(i);
  }
  const auto neighbours = [&](Index element, auto visit) {
    for (const Index vertex : batch[element].vertices)
      for (Index k = batch.at_vertex.offsets[vertex]; k < batch.at_vertex.offsets[vertex + 1]; ++k)
        if (const Index other = batch.at_vertex.items[k] / corners; other != element) visit(other);
  };
  colour_greedily(queue, neighbours, colour);
  return group(colour);
}

/// Whether the order in which VBD visits the element's vertices counts. Bending of pins alone is listed for
/// its energy: it moves nothing, and must not change the order of what moves.
template <class Law>
bool counts(const Model& model, const Element<Law>& element) {
  constexpr bool bends = std::is_same_v<Law, elements::Bending> || std::is_same_v<Law, elements::Shell>;
  return !bends || std::any_of(element.vertices.begin(), element.vertices.end(),
                               [&](Index vertex) { return model.pin_motion[vertex] == not_pinned; });
}

/// Takes the colours from the grids in which an element joins two vertices of one colour.
void drop_clashes(const Model& model, const scene::Scene& scene, std::vector<Index>& colour) {
  std::vector<char> clashes(scene.cloths.size(), 0);
  Pieces pieces;
  each_element(model.elements, [&](const auto& element) {
    pieces.next();
    if (!counts(model, element)) return;
    for (std::size_t b = 1; b < element.vertices.size(); ++b)
      for (std::size_t a = 0; a < b; ++a)
        if (colour[element.vertices[a]] == colour[element.vertices[b]])
          clashes[model.vertex_cloth[element.vertices[a]]] = 1;
  });
  for (Index i = 0; i < colour.size(); ++i)
    if (clashes[model.vertex_cloth[i]]) colour[i] = uncoloured;
}

}  // namespace

std::array<Colouring, elements::swept_count> colour_elements(const Model& model, const scene::Scene& scene) {
  std::array<Colouring, elements::swept_count> colourings;
  model.elements.each_swept([&]<class Law>(const Batch<Law>& batch) {
    colourings[elements::law_number<Law, elements::SweptLaws>] = colour_batch(model, scene, batch);
  });
  return colourings;
}

Colouring colour_vertices(const Model& model, const scene::Scene& scene) {
  std::vector<Index> colour(model.vertex_count(), uncoloured), queue;
  for (Index i = 0; i < model.vertex_count(); ++i) {
    const Index cloth = model.vertex_cloth[i];
    if (const scene::Grid* grid = grid_of(scene, cloth)) {
      const GridPlace at = place(*grid, i - model.cloths[cloth].first_vertex);
      colour[i] = (at.column + 2 * at.row) % 5;
    }
  }
  drop_clashes(model, scene, colour);
  for (Index i = 0; i < model.vertex_count(); ++i)
    if (colour[i] == uncoloured) queue.push_back(i);
  std::vector<Index> degree(model.vertex_count(), 0);
  model.elements.each([&](const auto& batch) {
    for (const auto& element : batch)
      if (counts(model, element))
        for (const Index vertex : element.vertices) ++degree[vertex];
  });
  between_pieces();
  std::stable_sort(queue.begin(), queue.end(), [&](Index a, Index b) { return degree[a] > degree[b]; });
  const auto neighbours = [&](Index vertex, auto visit) {
    model.elements.each([&](const auto& batch) {
      batch.at(vertex, [&](const auto& element, std::size_t) {
        if (!counts(model, element)) return;
        for (const Index other : element.vertices)
          if (other != vertex) visit(other);
      });
    });
  };
  colour_greedily(queue, neighbours, colour);
  return group(colour);
}

}  // namespace clothlab::model
