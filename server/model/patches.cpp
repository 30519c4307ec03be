#include "server/model/patches.h"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>
#include <span>
#include <tuple>

namespace clothlab::model {

namespace {

class Bisection {
 public:
  explicit Bisection(const Model& model) : model_(model), patch_of_(model.vertex_count()) {}

  std::vector<std::uint32_t> divided(std::uint32_t count) {
    std::vector<std::uint32_t> vertices(model_.vertex_count());
    std::iota(vertices.begin(), vertices.end(), 0U);
    std::stable_sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
      return model_.vertex_cloth[a] < model_.vertex_cloth[b];
    });
    divide(vertices, count);
    return std::move(patch_of_);
  }

 private:
  /// `vertices` lie cloth by cloth.
  void divide(std::span<std::uint32_t> vertices, std::uint32_t parts) {
    if (parts == 1) {
      for (const std::uint32_t vertex : vertices) patch_of_[vertex] = next_;
      ++next_;
      return;
    }
    const std::size_t size = vertices.size();
    std::uint32_t left_parts = parts / 2;
    std::size_t left = size * left_parts / parts;
    if (model_.vertex_cloth[vertices.front()] != model_.vertex_cloth[vertices.back()]) {
      left = nearest_boundary(vertices, left);
      left_parts = static_cast<std::uint32_t>((parts * left + size / 2) / size);
    } else {
      halve(vertices, left);
    }
    // Each part gets at least one patch, and no more than it has vertices.
    left_parts = std::clamp(left_parts, 1U, parts - 1);
    left_parts = std::min(left_parts, static_cast<std::uint32_t>(left));
    left_parts = std::max(left_parts, parts - std::min(parts, static_cast<std::uint32_t>(size - left)));
    divide(vertices.first(left), left_parts);
    divide(vertices.subspan(left), parts - left_parts);
  }

  /// The number of vertices before the change of cloth that is nearest to `wanted`.
  std::size_t nearest_boundary(std::span<const std::uint32_t> vertices, std::size_t wanted) const {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < vertices.size(); ++k) {
      if (model_.vertex_cloth[vertices[k - 1]] == model_.vertex_cloth[vertices[k]]) continue;
      const auto apart = [&](std::size_t at) { return at > wanted ? at - wanted : wanted - at; };
      if (nearest == 0 || apart(k) < apart(nearest)) nearest = k;
    }
    return nearest;
  }

  /// Puts the `left` vertices first that lie lowest along the longest extent.
  void halve(std::span<std::uint32_t> vertices, std::size_t left) const {
    dvec3 low = model_.rest_position[vertices.front()], high = low;
    for (const std::uint32_t vertex : vertices) {
      low = glm::min(low, model_.rest_position[vertex]);
      high = glm::max(high, model_.rest_position[vertex]);
    }
    const dvec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(left), vertices.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::tuple(model_.rest_position[a][axis], a) <
                              std::tuple(model_.rest_position[b][axis], b);
                     });
  }

  const Model& model_;
  std::vector<std::uint32_t> patch_of_;
  std::uint32_t next_ = 0;
};

}  // namespace

std::vector<std::uint32_t> patches(const Model& model, std::uint32_t count) {
  return Bisection(model).divided(count);
}

}  // namespace clothlab::model
