// The element laws as C++ functions in double precision, from the same files that the kernels
// include; and the types that templates over laws need.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <utility>

namespace clothlab::elements {

using real = double;
using vec3 = glm::dvec3;
using glm::cross;
using glm::dot;
using glm::max;
using glm::min;
using std::sqrt;

#define FUNCTION inline
#define PRECISE
#define OUT(T) T&
#define INOUT(T) T&
#include "shaders/elements/contact.glsl"
#include "shaders/elements/solid.glsl"
#include "shaders/elements/spring.glsl"
#undef FUNCTION
#undef PRECISE
#undef OUT
#undef INOUT

/// Number of corners of an element of that law.
template <class Law>
inline constexpr std::size_t corners = 0;
template <>
inline constexpr std::size_t corners<Spring> = 2;

template <class Law>
struct EdgesOf;
template <>
struct EdgesOf<Spring> {
  using type = SpringEdges;
};
template <class Law>
using Edges = typename EdgesOf<Law>::type;

template <class Law>
using Hessian = decltype(element_hessian(Law{}, Edges<Law>{}));

/// Edges of a corner: `difference(k)` is the corner's value less that of the k-th other corner, k
/// from 0.
template <class Law, class Difference>
Edges<Law> make_edges(Difference&& difference) {
  static_assert(sizeof(Edges<Law>) == (corners<Law> - 1) * sizeof(vec3), "edges are the differences alone");
  return [&]<std::size_t... others>(std::index_sequence<others...>) {
    return Edges<Law>{difference(others)...};
  }
  (std::make_index_sequence<corners<Law> - 1>());
}

}  // namespace clothlab::elements
