// Elements as data. For each element law (shaders/elements/) there is a batch with the vertices, rest values
// and material of its elements. Batches::each and each_element loop over all of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <vector>

#include "shaders/elements/elements.h"

namespace clothlab::model {

using glm::dvec3;

/// For each vertex i the items [offsets[i], offsets[i+1]) (compressed sparse rows).
struct Adjacency {
  std::vector<std::uint32_t> offsets;  ///< [vertex_count + 1]
  std::vector<std::uint32_t> items;
};

template <class Law>
struct Element {
  static constexpr std::size_t corners = elements::corners<Law>;
  std::array<std::uint32_t, corners> vertices{};  ///< the corners; a spring's are in rising order
  Law law;                                        ///< rest values and material

  bool operator==(const Element& other) const {
    return vertices == other.vertices && elements::numbers(law) == elements::numbers(other.law);
  }
};
using Spring = Element<elements::Spring>;

template <class Law>
struct Batch : std::vector<Element<Law>> {
  /// For each vertex the element corners at it, each as element * corners + corner, in rising order.
  Adjacency at_vertex;

  /// Calls visit(element, corner) for each element that has `vertex` as its corner number `corner`.
  template <class Visit>
  void at(std::uint32_t vertex, Visit&& visit) const {
    constexpr auto corners = static_cast<std::uint32_t>(Element<Law>::corners);
    for (std::uint32_t k = at_vertex.offsets[vertex]; k < at_vertex.offsets[vertex + 1]; ++k)
      visit((*this)[at_vertex.items[k] / corners], std::size_t{at_vertex.items[k] % corners});
  }
};

/// The batches of a model, one for each law. Those of laws that only sweeps visit are empty under other
/// methods.
class Batches {
 public:
  template <class Law>
  const Batch<Law>& of() const {
    return std::get<Batch<Law>>(batches_);
  }
  template <class Law>
  Batch<Law>& of() {
    return std::get<Batch<Law>>(batches_);
  }
  /// Calls visit(batch) for the batch of each law whose forces add up, in the order of the laws.
  template <class Visit>
  void each(Visit&& visit) const {
    elements::each_law([&]<class Law>(std::type_identity<Law>) { visit(of<Law>()); });
  }
  /// Calls visit(batch) for the batch of each law that PBD and XPBD visit.
  template <class Visit>
  void each_swept(Visit&& visit) const {
    elements::each_law<elements::SweptLaws>([&]<class Law>(std::type_identity<Law>) { visit(of<Law>()); });
  }
  template <class Visit>
  void each_of_all(Visit&& visit) {
    std::apply([&](auto&... batch) { (visit(batch), ...); }, batches_);
  }
  /// True if both have the same elements in the same order.
  bool operator==(const Batches& other) const { return batches_ == other.batches_; }

 private:
  elements::PerLaw<Batch, elements::AllLaws> batches_;
};

/// An element's edges as seen from one of its corners. `difference(vertex)` must return the value at this
/// corner less the value at `vertex`; it is called for each other corner, in cyclic order from this one.
template <class Law, class Difference>
elements::Edges<Law> edges(const Element<Law>& element, std::size_t corner, Difference&& difference) {
  return elements::make_edges<Law>([&](std::size_t other) {
    return difference(element.vertices[(corner + 1 + other) % Element<Law>::corners]);
  });
}

/// The edges of an element in `field` [vertex_count], for example positions or velocities.
template <class Law>
elements::Edges<Law> edges(const Element<Law>& element, std::size_t corner, const std::vector<dvec3>& field) {
  const dvec3& here = field[element.vertices[corner]];
  return edges(element, corner, [&](std::uint32_t vertex) { return here - field[vertex]; });
}

/// An element's law as seen from one of its corners.
template <class Law>
Law law_at(const Element<Law>& element, std::size_t corner) {
  return elements::seen_from(element.law, static_cast<int>(corner));
}

/// Calls visit(element) for every element of every law.
template <class Visit>
void each_element(const Batches& batches, Visit&& visit) {
  batches.each([&](const auto& batch) {
    for (const auto& element : batch) visit(element);
  });
}

}  // namespace clothlab::model
