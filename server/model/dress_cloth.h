// Cloth that is led out: places, lengths that it should keep, and what holds instead. Internal to dress.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// The ends of an edge, the smaller number first.
inline std::array<std::uint32_t, 2> in_order(std::uint32_t a, std::uint32_t b) {
  return {a < b ? a : b, a < b ? b : a};
}

/// `normal` . (sum of share * place) >= least. The places are those of cloths' vertices; a share that is not
/// used is 0.
struct Demand {
  std::array<std::uint32_t, 5> vertices{};
  std::array<double, 5> shares{};
  dvec3 normal{0.0};  ///< unit length
  double least = 0;   ///< [m]
};

class DressCloth {
 public:
  /// Vertices of cloths that are not led out, and pinned ones, stay.
  DressCloth(const Model& model, const std::vector<std::uint8_t>& led_out);

  using Edge = std::array<std::uint32_t, 2>;
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<dvec3> x;  ///< [vertex_count] [m]
  const std::vector<Triangle>& triangles;
  std::vector<Edge> edges;           ///< in rising order
  std::vector<std::uint32_t> piece;  ///< [vertex_count] cloth that hangs together has one number

  bool moves(std::uint32_t vertex) const { return weight_[vertex] > 0.0; }
  /// The triangles at an edge.
  std::span<const std::uint32_t> triangles_at(const Edge& edge) const;
  std::uint32_t index_of(const Triangle& triangle) const { return index_.at(triangle); }
  bool on_border(std::uint32_t vertex) const { return border_[vertex]; }
  double mean_edge() const { return mean_edge_; }

  /// Moves the vertices, each by `most` [m] at most: towards the lengths of the start, and to where `demands`
  /// hold.
  void relax(const std::vector<Demand>& demands, double most);

  /// The sum of the squares of the shares by which edges are longer or shorter than at the start.
  double squared_strain() const;

 private:
  struct Length {
    std::uint32_t a, b;
    double length;     ///< [m]
    double stiffness;  ///< share of the difference that a sweep undoes
  };
  void list_edges();
  void list_lengths(const Model& model);
  void list_pieces();
  void keep_lengths();
  void keep(const Demand& demand, double most);

  std::vector<double> weight_;                          // 1, or 0 for a vertex that stays
  std::vector<std::uint32_t> first_at_edge_, at_edge_;  // compressed rows of triangles
  std::map<Triangle, std::uint32_t> index_;
  std::vector<bool> border_;
  std::vector<Length> lengths_;
  double mean_edge_ = 0;
};

}  // namespace clothlab::model
