#include "server/model/spring_operator.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "server/model/small_eigen.h"

namespace clothlab::model {

SpringOperator::SpringOperator(const Model& model, const scene::Scene& scene, const Field& shape)
    : air_drag_(scene.air_drag) {
  scale_.reserve(model.mass.size());
  links_.reserve(model.springs.size());
  for (std::size_t i = 0; i < model.mass.size(); ++i)
    scale_.push_back(model.pin_motion[i] == not_pinned ? 1.0 / std::sqrt(model.mass[i]) : 0.0);
  for (const Spring& spring : model.springs) {
    if (pinned(spring.a) && pinned(spring.b)) continue;
    const scene::Springs& material = scene.cloths[spring.cloth].material;
    const double k = stiffness(material, spring.kind);
    const dvec3 d = shape[spring.a] - shape[spring.b];
    const double length = glm::length(d);
    Link link{spring.a, spring.b, dvec3(0.0), k, k, 0.0};  // without a direction: the same every way
    if (length > 0.0) {
      link.direction = d / length;
      link.across = k * std::max(0.0, 1.0 - spring.rest_length / length);
      link.damping = material.damping;
    }
    // The rest shape is computed with rounding: what it leaves across is no tension.
    if (link.across < 1e-9 * k) link.across = 0.0;
    links_.push_back(link);
  }
}

bool SpringOperator::any_free() const {
  return std::any_of(scale_.begin(), scale_.end(), [](double scale) { return scale > 0.0; });
}

void SpringOperator::apply(const Field& y, Field& stiff, Field& damped) const {
  for (std::size_t i = 0; i < y.size(); ++i) {
    stiff[i] = dvec3(0.0);
    damped[i] = air_drag_ * y[i];
  }
  for (const Link& link : links_) {
    const double of_a = scale_[link.a], of_b = scale_[link.b];
    const dvec3 apart = of_a * y[link.a] - of_b * y[link.b];
    const double along = glm::dot(link.direction, apart);
    const dvec3 force = (link.along - link.across) * along * link.direction + link.across * apart;
    const dvec3 drag = link.damping * along * link.direction;
    stiff[link.a] += of_a * force;
    stiff[link.b] -= of_b * force;
    damped[link.a] += of_a * drag;
    damped[link.b] -= of_b * drag;
  }
}

// A spring's share of y.Ky is k (p - q)^2 with p = n.y_a / sqrt(m_a) and q = n.y_b / sqrt(m_b), and
// (p - q)^2 <= 2 p^2 + 2 q^2 whatever the masses: K is bounded by a matrix of one 3x3 block a vertex, the sum
// of 2 k n n^T / m over its springs. Where the other end is pinned q is 0, and the share is p^2, not 2 p^2.
double SpringOperator::bound(double Link::*along, double Link::*across) const {
  std::vector<glm::dmat3> block(scale_.size(), glm::dmat3(0.0));
  for (const Link& link : links_) {
    const double across_it = across ? link.*across : 0.0;
    const glm::dmat3 spring =
        (link.*along - across_it) * glm::outerProduct(link.direction, link.direction) + glm::dmat3(across_it);
    const double ends = pinned(link.a) || pinned(link.b) ? 1.0 : 2.0;
    block[link.a] += ends * scale_[link.a] * scale_[link.a] * spring;
    block[link.b] += ends * scale_[link.b] * scale_[link.b] * spring;
  }
  double largest = 0.0;
  for (const glm::dmat3& matrix : block) largest = std::max(largest, largest_eigenpair(matrix).value);
  return largest;
}

double SpringOperator::stiffness_bound() const {
  return bound(&Link::along, &Link::across);
}

double SpringOperator::damping_bound() const {
  return bound(&Link::damping, nullptr) + air_drag_;
}

double SpringOperator::least_damping_time() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Link& link : links_)
    least = std::min(least, link.across > 0.0 ? 0.0 : link.damping / link.along);
  return least;
}

}  // namespace clothlab::model
