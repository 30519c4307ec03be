#include "server/sim/coarse_modes.h"

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "server/model/small_eigen.h"

namespace clothlab::sim {

namespace {

using glm::dmat3;
using glm::dvec3;

/// Share of the variance along the first axis below which there is nothing along the second but rounding.
constexpr double nothing = 1e-8;

/// Gives the vertices of a patch, none of which is pinned, their shares.
void share_out(const std::vector<dvec3>& rest, const std::vector<std::uint32_t>& members,
               std::vector<Shares>& shares) {
  const auto number = static_cast<double>(members.size());
  dvec3 middle(0.0);
  for (const std::uint32_t i : members) middle += rest[i] / number;
  dmat3 variance(0.0);
  for (const std::uint32_t i : members)
    variance += glm::outerProduct(rest[i] - middle, (rest[i] - middle) / number);
  for (const std::uint32_t i : members) shares[i][0] = 1.0;
  double largest = 0.0;
  for (std::size_t mode = 1; mode < patch_modes; ++mode) {
    const model::Eigenpair axis = model::largest_eigenpair(variance);
    if (!(axis.value > nothing * largest)) return;
    largest = std::max(largest, axis.value);
    for (const std::uint32_t i : members)
      shares[i][mode] = glm::dot(rest[i] - middle, axis.vector) / std::sqrt(axis.value);
    variance -= glm::outerProduct(axis.value * axis.vector, axis.vector);
  }
}

}  // namespace

std::vector<Shares> shares_in_patches(const model::Model& model, const std::vector<std::uint32_t>& patch_of,
                                      std::uint32_t count) {
  std::vector<std::vector<std::uint32_t>> members(count);
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] == model::not_pinned) members[patch_of[i]].push_back(i);
  std::vector<Shares> shares(model.vertex_count(), Shares{});
  for (const std::vector<std::uint32_t>& of_patch : members) share_out(model.rest_position, of_patch, shares);
  return shares;
}

}  // namespace clothlab::sim
