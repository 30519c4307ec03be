#include "server/reference/stage_equation.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "server/reference/block_factor.h"
#include "server/reference/wind.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

/// Adds the tension that damping gives now, so that it turns with the element like that of elasticity.
template <class Law, class Hessian>
void add_damped_stress(const Law&, const elements::Edges<Law>&, Hessian&) {}
template <>
void add_damped_stress(const elements::Spring& law, const elements::SpringEdges& velocity,
                       elements::SpringHessian& hessian) {
  if (hessian.along > 0.0 && law.rest_length > 0.0)
    hessian.across += law.damping * glm::dot(hessian.n, velocity.d[0]) * (hessian.along - hessian.across) /
                      (hessian.along * law.rest_length);  // over the length now
}
template <>
void add_damped_stress(const elements::Membrane& law, const elements::MembraneEdges& velocity,
                       elements::MembraneHessian& hessian) {
  hessian.stress += law.damping * elements::membrane_stress(
                                      law, elements::strain_change(hessian.f, gradient(law, velocity)));
}

}  // namespace

struct StageEquation::Assembly {
  BlockFactor matrix;
  /// For each element and each pair of its free corners, a column not after a row, the block that it adds to.
  std::vector<BlockFactor::Slot> slots = {};
  std::vector<BlockFactor::Slot> diagonal = {};  ///< [free vertex]
  Eigen::VectorXd solved = {};
};

StageEquation::~StageEquation() = default;

StageEquation::StageEquation(const World& world) : world_(world), number_(world.model.vertex_count(), -1) {
  Vectors places;
  for (std::size_t i = 0; i < number_.size(); ++i) {
    if (world.pinned(i)) continue;
    number_[i] = static_cast<std::int32_t>(places.size());
    places.push_back(world.model.rest_position[i]);
  }
  const auto is_free = [&](std::uint32_t vertex) { return number_[vertex] >= 0; };
  const auto number = [&](std::uint32_t vertex) { return static_cast<std::uint32_t>(number_[vertex]); };
  std::vector<std::vector<std::uint32_t>> neighbours(places.size());
  model::each_element(world.model.elements, [&](const auto& element) {
    for (const std::uint32_t one : element.vertices)
      for (const std::uint32_t other : element.vertices)
        if (one != other && is_free(one) && is_free(other)) neighbours[number(one)].push_back(number(other));
  });
  for (std::vector<std::uint32_t>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  assembly_.reset(new Assembly{BlockFactor(neighbours, places)});
  const BlockFactor& matrix = assembly_->matrix;
  model::each_element(world.model.elements, [&](const auto& element) {
    for (std::size_t row = 0; row < element.corners; ++row)
      for (std::size_t column = 0; column <= row; ++column) {
        const std::uint32_t a = element.vertices[row], b = element.vertices[column];
        if (is_free(a) && is_free(b)) assembly_->slots.push_back(matrix.slot(number(a), number(b)));
      }
  });
  for (std::uint32_t i = 0; i < places.size(); ++i) assembly_->diagonal.push_back(matrix.slot(i, i));
}

void StageEquation::set(Vectors x, Vectors v, double t, double h) {
  x_ = std::move(x);
  v_ = std::move(v);
  t_ = t;
  h_ = h;
  at_time(world_, t);
  pin_place_ = x_;
  pin_velocity_ = v_;
  place_pins(world_, t_, pin_place_, pin_velocity_);
}

Vectors StageEquation::places(Vectors& velocity) const {
  Vectors x = x_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (number_[i] >= 0) {
      x[i] += h_ * velocity[i];
    } else {
      x[i] = pin_place_[i];
      velocity[i] = pin_velocity_[i];
    }
  }
  return x;
}

Vectors StageEquation::residual(const Vectors& velocity) const {
  Vectors v = velocity;
  const Vectors x = places(v);
  Vectors r = element_forces(world_, x, v);
  const std::vector<elements::WindLoad> wind = wind_loads(world_, x, v, t_);
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (number_[i] < 0) {
      r[i] = dvec3(0.0);
      continue;
    }
    const dvec3 outer = world_.scene.gravity - world_.scene.air_drag * v[i];
    const double mass = world_.model.mass[i];
    r[i] = mass * (v[i] - v_[i]) - h_ * (r[i] + wind[i].force + mass * outer);
  }
  return r;
}

template <class Law>
void StageEquation::add_element(const model::Element<Law>& element, const Vectors& x, const Vectors& v,
                                Matrix kind, std::size_t& next) {
  constexpr std::size_t corners = model::Element<Law>::corners;
  for (std::size_t row = 0; row < corners; ++row) {
    if (number_[element.vertices[row]] < 0) continue;
    const Law law = law_at(element, row);
    auto hessian = element_hessian(law, edges(element, row, x));
    add_damped_stress(law, edges(element, row, v), hessian);
    if (kind == Matrix::definite) hessian = element_definite(hessian);
    const auto stiffness = stiffness_matrix(hessian);
    const auto damping = damping_matrix(hessian);
    for (std::size_t column = 0; column <= row; ++column) {
      if (number_[element.vertices[column]] < 0) continue;
      const BlockFactor::Slot slot = assembly_->slots[next++];
      const std::size_t other = (column + corners - row - 1) % corners;  // seen from the row's corner
      Eigen::Matrix3d& block = assembly_->matrix.block(slot.block);
      for (int axis = 0; axis < 3; ++axis) {
        dvec3 along(0.0);
        along[axis] = 1.0;
        const auto moves = elements::make_edges<Law>([&](std::size_t k) {
          return row == column ? along : k == other ? -along : dvec3(0.0);
        });
        const dvec3 felt = h_ * h_ * matrix_product(stiffness, moves) + h_ * matrix_product(damping, moves);
        for (int to = 0; to < 3; ++to) (slot.transposed ? block(axis, to) : block(to, axis)) += felt[to];
      }
    }
  }
}

void StageEquation::assemble(const Vectors& velocity, Matrix kind) {
  Vectors v = velocity;
  const Vectors x = places(v);
  const std::vector<elements::WindLoad> wind = wind_loads(world_, x, v, t_);
  assembly_->matrix.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (number_[i] < 0) continue;
    const double mass = world_.model.mass[i];
    assembly_->matrix.block(assembly_->diagonal[static_cast<std::size_t>(number_[i])].block)
        .diagonal()
        .array() += mass * (1.0 + h_ * world_.scene.air_drag) + h_ * wind[i].braking;
  }
  std::size_t next = 0;
  model::each_element(world_.model.elements,
                      [&](const auto& element) { add_element(element, x, v, kind, next); });
}

bool StageEquation::factor(const Vectors& velocity, const std::stop_token& stop) {
  for (const Matrix kind : {Matrix::exact, Matrix::definite}) {
    assemble(velocity, kind);
    const BlockFactor::Outcome outcome = assembly_->matrix.factor(stop);
    if (outcome != BlockFactor::Outcome::indefinite) return outcome == BlockFactor::Outcome::done;
  }
  return false;
}

Vectors StageEquation::newton_step(const Vectors& residual) {
  Eigen::VectorXd& solved = assembly_->solved;
  solved.resize(static_cast<Eigen::Index>(3 * assembly_->diagonal.size()));
  for (std::size_t i = 0; i < residual.size(); ++i)
    for (int axis = 0; number_[i] >= 0 && axis < 3; ++axis)
      solved[3 * static_cast<Eigen::Index>(number_[i]) + axis] = -residual[i][axis];
  assembly_->matrix.solve(solved);
  Vectors step(residual.size(), dvec3(0.0));
  for (std::size_t i = 0; i < residual.size(); ++i)
    for (int axis = 0; number_[i] >= 0 && axis < 3; ++axis)
      step[i][axis] = solved[3 * static_cast<Eigen::Index>(number_[i]) + axis];
  return step;
}

}  // namespace clothlab::reference
