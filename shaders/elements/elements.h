// The element laws as C++ functions in double precision, from the same files that the kernels
// include; and the types that templates over laws need.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <tuple>
#include <type_traits>
#include <utility>

namespace clothlab::elements {

using real = double;
using vec3 = glm::dvec3;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::max;
using glm::min;
using std::log;
using std::sqrt;

#define FUNCTION inline
#define PRECISE
#define UNUSED(name)
#define OUT(T) T&
#define INOUT(T) T&
#include "shaders/elements/bending.glsl"
#include "shaders/elements/constraint.glsl"
#include "shaders/elements/contact.glsl"
#include "shaders/elements/curvature.glsl"
#include "shaders/elements/membrane.glsl"
#include "shaders/elements/shell.glsl"
#include "shaders/elements/solid.glsl"
#include "shaders/elements/spring.glsl"
#include "shaders/elements/surface.glsl"
#include "shaders/elements/surface_energy.glsl"
#include "shaders/elements/wind.glsl"
#undef FUNCTION
#undef PRECISE
#undef UNUSED
#undef OUT
#undef INOUT

/// What C++ must know of a law: its name in kernels, the number of its element's corners, and how many of its
/// numbers, the first ones, a visit of PBD or XPBD reads; what the others do is in the gains.
template <class Law>
struct Facts;
template <>
struct Facts<Spring> {
  static constexpr const char* name = "Spring";
  static constexpr std::size_t corners = 2, visit_numbers = 1;
  using Edges = SpringEdges;
};

template <>
struct Facts<Membrane> {
  static constexpr const char* name = "Membrane";
  static constexpr std::size_t corners = 3, visit_numbers = 9;
  using Edges = MembraneEdges;
};
template <>
struct Facts<Bending> {
  static constexpr const char* name = "Bending";
  static constexpr std::size_t corners = 2, visit_numbers = 0;
  using Edges = BendingEdges;
};
template <>
struct Facts<Shell> {
  static constexpr const char* name = "Shell";
  static constexpr std::size_t corners = 4, visit_numbers = 0;
  using Edges = ShellEdges;
};
template <>
struct Facts<Curvature> {
  static constexpr const char* name = "Curvature";
  static constexpr std::size_t corners = 12, visit_numbers = 40;
  using Edges = CurvatureEdges;
};

/// The laws whose forces and energies add up to the sheet's, in the order of their batches and lists.
using Laws = std::tuple<Spring, Membrane, Bending, Shell>;
inline constexpr std::size_t law_count = std::tuple_size_v<Laws>;

/// The laws that PBD and XPBD visit. Bending is the same to them as to the others, in another form: elements
/// of either sign cannot be visited one by one.
using SweptLaws = std::tuple<Spring, Membrane, Curvature>;
inline constexpr std::size_t swept_count = std::tuple_size_v<SweptLaws>;

/// All of them, each once.
using AllLaws = std::tuple<Spring, Membrane, Bending, Shell, Curvature>;

template <class Law>
inline constexpr std::size_t corners = Facts<Law>::corners;
template <class Law>
using Edges = typename Facts<Law>::Edges;
template <class Law>
using Hessian = decltype(element_hessian(Law{}, Edges<Law>{}));

/// Texels of four numbers that kernels read of an element: in an entry of a vertex's list
/// (elements/lists.glsl) the other corners and the law; in a visit of a sweep
/// (methods/element_projection.glsl) all corners, some numbers and three gains.
template <class Law>
inline constexpr std::size_t entry_texels = (corners<Law> - 1 + sizeof(Law) / sizeof(real) + 3) / 4;
template <class Law>
inline constexpr std::size_t visit_texels = (corners<Law> + Facts<Law>::visit_numbers + 3 + 3) / 4;

/// A tuple with an Of<Law> for each law of a list.
template <template <class> class Of, class... All>
std::tuple<Of<All>...> per_law(const std::tuple<All...>*);
template <template <class> class Of, class List = Laws>
using PerLaw = decltype(per_law<Of>(static_cast<const List*>(nullptr)));

/// Calls visit(std::type_identity<Law>{}) for each law of a list.
template <class List = Laws, class Visit>
void each_law(Visit&& visit) {
  const auto all = [&]<class... All>(const std::tuple<All...>*) { (visit(std::type_identity<All>{}), ...); };
  all(static_cast<const List*>(nullptr));
}

/// A law's place in a list.
template <class Law, class List = Laws>
inline constexpr std::size_t law_number = []<class... All>(const std::tuple<All...>*) {
  std::size_t number = 0;
  bool found = false;
  ((found = found || std::is_same_v<All, Law>, number += found ? 0 : 1), ...);
  return number;
}(static_cast<const List*>(nullptr));

/// The law's rest values and material as numbers, in the order of its members.
template <class Law>
auto numbers(const Law& law) {
  return std::bit_cast<std::array<real, sizeof(Law) / sizeof(real)>>(law);
}

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
