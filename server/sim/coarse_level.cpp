#include "server/sim/coarse_level.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "server/model/patches.h"
#include "server/sim/plan.h"
#include "shaders/slots.h"

namespace clothlab::sim {

namespace {

using glm::dmat3;
using glm::dvec3;
using model::Element;

/// More patches make fewer iterations, but their inverse grows with the cube of their number. In a seed of
/// 25x25 vertices 31 patches spare two iterations in five, in one of 64x64 48 do (tests/README.md).
constexpr std::uint32_t vertices_a_patch = 20, most_patches = 48;
static_assert(most_patches <= group_size);  // shaders/methods/implicit_step.comp has a thread for each

std::uint32_t patch_count(std::uint32_t vertices) {
  return std::clamp(vertices / vertices_a_patch, 1U, most_patches);
}

/// The lists of shaders/methods/implicit_patches.glsl, one after another. A work group has a slot for each
/// patch of which it has vertices, for its part of the patch's sum.
struct Lists {
  std::vector<std::uint32_t> words;
  std::vector<std::pair<const char*, GLint>> first;  ///< where each list begins
  std::uint32_t slots = 0;

  void add(const char* name, const std::vector<std::uint32_t>& list) {
    first.emplace_back(name, static_cast<GLint>(words.size()));
    words.insert(words.end(), list.begin(), list.end());
  }
};

Lists lists_of(const std::vector<std::uint32_t>& patch_of, std::uint32_t count) {
  const auto vertices = static_cast<std::uint32_t>(patch_of.size());
  std::vector<std::uint32_t> group_slots{0}, slot_members{0}, members;
  std::vector<std::vector<std::uint32_t>> slots_of(count);
  for (std::uint32_t first = 0; first < vertices; first += group_size) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> lanes;  // patch, lane
    for (std::uint32_t i = first; i < std::min(first + group_size, vertices); ++i)
      lanes.emplace_back(patch_of[i], i - first);
    std::sort(lanes.begin(), lanes.end());
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      members.push_back(lanes[k].second);
      if (k + 1 < lanes.size() && lanes[k + 1].first == lanes[k].first) continue;
      slots_of[lanes[k].first].push_back(static_cast<std::uint32_t>(slot_members.size()) - 1);
      slot_members.push_back(static_cast<std::uint32_t>(members.size()));
    }
    group_slots.push_back(static_cast<std::uint32_t>(slot_members.size()) - 1);
  }
  std::vector<std::uint32_t> patch_slots{0}, slots;
  for (const std::vector<std::uint32_t>& of_patch : slots_of) {
    slots.insert(slots.end(), of_patch.begin(), of_patch.end());
    patch_slots.push_back(static_cast<std::uint32_t>(slots.size()));
  }
  Lists lists;
  lists.slots = static_cast<std::uint32_t>(slots.size());
  lists.add("patch_of", patch_of);
  lists.add("group_slots", group_slots);
  lists.add("slot_members", slot_members);
  lists.add("members", members);
  lists.add("patch_slots", patch_slots);
  lists.add("slots", slots);
  return lists;
}

dvec3 xyz(const glm::vec4& v) {
  return dvec3(v.x, v.y, v.z);
}

/// L D L^T of shaders/methods/blocks.glsl.
dmat3 block(const glm::vec4& a, const glm::vec4& b) {
  const dmat3 lower(dvec3(1.0, b.x, b.y), dvec3(0.0, 1.0, b.z), dvec3(0.0, 0.0, 1.0));
  const dmat3 pivots(dvec3(1.0 / a.x, 0.0, 0.0), dvec3(0.0, 1.0 / a.y, 0.0), dvec3(0.0, 0.0, 1.0 / a.z));
  return lower * pivots * glm::transpose(lower);
}

/// What a contact keeps from moving: all, or what is along its normal. 0: no contact.
dmat3 held_part(const glm::vec4& constraint) {
  if (constraint.w < 0.0F) return dmat3(1.0);
  const dvec3 n = xyz(constraint);
  return glm::outerProduct(n, n);
}

std::vector<glm::vec4> downloaded(const gl::TextureBuffer& source) {
  std::vector<glm::vec4> vectors(source.buffer.bytes() / sizeof(glm::vec4));
  source.buffer.download(vectors.data(), source.buffer.bytes());
  return vectors;
}

}  // namespace

struct CoarseLevel::Parts {
  template <class Law>
  using Elements = std::vector<Element<Law>>;

  std::vector<std::uint32_t> patch_of;  ///< [vertex]
  std::uint32_t count = 1;
  Lists lists;
  gl::TextureBuffer words, inverse, sums, vectors;
  elements::PerLaw<Elements> joints;  ///< elements of several patches, or at a pin: the others do not deform
  std::vector<bool> pinned;           ///< [vertex]
  double dt = 0, air_drag = 0;

  template <class Law>
  void keep_joints(const model::Batch<Law>& batch);
  template <class Law>
  void add(const Element<Law>& element, const std::vector<glm::vec4>& position,
           Eigen::MatrixXd& matrix) const;
  /// Adds `part` [kg] to the block of two patches.
  static void add(Eigen::MatrixXd& matrix, std::uint32_t row, std::uint32_t column, const dmat3& part) {
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) matrix(3 * row + r, 3 * column + c) += part[c][r];
  }
  Eigen::MatrixXd matrix_of(const FineLevel& fine, bool contacts) const;
};

template <class Law>
void CoarseLevel::Parts::keep_joints(const model::Batch<Law>& batch) {
  auto& kept = std::get<Elements<Law>>(joints);
  kept.clear();
  for (const Element<Law>& element : batch) {
    const auto& vertices = element.vertices;
    const bool several = std::any_of(vertices.begin(), vertices.end(), [&](std::uint32_t vertex) {
      return patch_of[vertex] != patch_of[vertices[0]];
    });
    const auto is_pinned = [&](std::uint32_t vertex) { return pinned[vertex]; };
    if ((several || std::any_of(vertices.begin(), vertices.end(), is_pinned)) &&
        !std::all_of(vertices.begin(), vertices.end(), is_pinned))
      kept.push_back(element);
  }
}

/// A corner's row of the element's matrix is linear in its edges: it is the sum of a 3x3 block times each
/// edge.
template <class Law>
void CoarseLevel::Parts::add(const Element<Law>& element, const std::vector<glm::vec4>& position,
                             Eigen::MatrixXd& matrix) const {
  for (std::size_t corner = 0; corner < Element<Law>::corners; ++corner) {
    const std::uint32_t here = element.vertices[corner];
    if (pinned[here]) continue;
    const auto row = elements::step_matrix(
        elements::element_hessian(
            law_at(element, corner),
            model::edges(element, corner,
                         [&](std::uint32_t other) { return xyz(position[here]) - xyz(position[other]); })),
        dt);
    for (std::size_t other = 0; other + 1 < Element<Law>::corners; ++other) {
      dmat3 part;
      for (int axis = 0; axis < 3; ++axis) {
        dvec3 unit(0.0);
        unit[axis] = 1.0;
        part[axis] = elements::matrix_product(row, elements::make_edges<Law>([&](std::size_t edge) {
                                                return edge == other ? unit : dvec3(0.0);
                                              }));
      }
      add(matrix, patch_of[here], patch_of[here], part);
      const std::uint32_t there = element.vertices[(corner + 1 + other) % Element<Law>::corners];
      if (!pinned[there]) add(matrix, patch_of[here], patch_of[there], -part);
    }
  }
}

Eigen::MatrixXd CoarseLevel::Parts::matrix_of(const FineLevel& fine, bool contacts) const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  const std::vector<glm::vec4> position = downloaded(fine.position);
  for (std::size_t i = 0; i < patch_of.size(); ++i)
    if (position[i].w > 0.0F)
      add(matrix, patch_of[i], patch_of[i], dmat3((1.0 + dt * air_drag) / position[i].w));
  const auto add_all = [&](const auto& of_law) {
    for (const auto& element : of_law) add(element, position, matrix);
  };
  std::apply([&](const auto&... of_law) { (add_all(of_law), ...); }, joints);
  if (contacts) {
    // A vertex that is held while its patch moves stretches all of its elements.
    const std::vector<glm::vec4> constraint = downloaded(fine.constraint), a = downloaded(fine.block_a),
                                 b = downloaded(fine.block_b);
    for (std::size_t i = 0; i < patch_of.size(); ++i) {
      if (constraint[i] == glm::vec4(0.0F) || !(position[i].w > 0.0F)) continue;
      const dmat3 held = held_part(constraint[i]);
      add(matrix, patch_of[i], patch_of[i], held * block(a[i], b[i]) * held);
    }
  }
  for (Eigen::Index k = 0; k < matrix.rows(); ++k)
    if (matrix(k, k) == 0.0) matrix(k, k) = 1.0;  // all vertices of the patch are pinned
  return matrix;
}

CoarseLevel::CoarseLevel(const model::Model& model) : parts_(std::make_unique<Parts>()) {
  Parts& parts = *parts_;
  parts.count = patch_count(model.vertex_count());
  parts.patch_of = model::patches(model, parts.count);
  parts.lists = lists_of(parts.patch_of, parts.count);
  const auto vectors = [](std::size_t count) {
    return gl::TextureBuffer(gl::Buffer(count * sizeof(glm::vec4)), GL_RGBA32F);
  };
  parts.words = {gl::Buffer(parts.lists.words), GL_R32UI};
  parts.inverse = vectors(std::size_t{3} * parts.count * parts.count);
  parts.sums = vectors(std::size_t{2} * parts.lists.slots);
  parts.vectors = vectors(std::size_t{3} * parts.count);
}

CoarseLevel::~CoarseLevel() = default;
CoarseLevel::CoarseLevel(CoarseLevel&&) noexcept = default;
CoarseLevel& CoarseLevel::operator=(CoarseLevel&&) noexcept = default;

void CoarseLevel::set_lists(const gl::Program& program) const {
  for (const auto& [name, first] : parts_->lists.first) program.set(name, first);
  program.set("patch_count", static_cast<GLint>(parts_->count));
}

void CoarseLevel::set_parameters(const model::Model& model, const scene::Scene& scene) {
  parts_->dt = scene.solver.dt;
  parts_->air_drag = scene.air_drag;
  parts_->pinned.assign(model.vertex_count(), false);
  for (std::size_t i = 0; i < model.vertex_count(); ++i)
    parts_->pinned[i] = model.pin_motion[i] != model::not_pinned;
  model.elements.each([&](const auto& batch) { parts_->keep_joints(batch); });
}

void CoarseLevel::prepare(const FineLevel& fine, bool contacts) {
  const std::uint32_t count = parts_->count;
  const Eigen::MatrixXd matrix = parts_->matrix_of(fine, contacts);
  const Eigen::LLT<Eigen::MatrixXd> factors(matrix);
  Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  // A cloth that blows up may leave no such matrix: then block Jacobi works alone.
  if (factors.info() != Eigen::Success || !inverse.allFinite()) inverse.setZero();
  std::vector<glm::vec4> rows;
  rows.reserve(std::size_t{3} * count * count);
  for (std::uint32_t row = 0; row < count; ++row)
    for (std::uint32_t column = 0; column < count; ++column)
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        rows.emplace_back(inverse(3 * row + axis, 3 * column), inverse(3 * row + axis, 3 * column + 1),
                          inverse(3 * row + axis, 3 * column + 2), 0.0);
  parts_->inverse.buffer.upload(rows.data(), rows.size() * sizeof(glm::vec4));
}

void CoarseLevel::bind() const {
  parts_->words.bind(unit_patch_lists);
  parts_->inverse.bind(unit_coarse_inverse);
  parts_->sums.bind(unit_patch_sums);
  parts_->vectors.bind(unit_coarse_vectors);
  parts_->sums.buffer.bind_storage(slot_patch_sums);
}

void CoarseLevel::bind_vectors() const {
  parts_->vectors.buffer.bind_storage(slot_coarse_vectors);
}

}  // namespace clothlab::sim
