#include "server/sim/coarse_level.h"

#include <algorithm>
#include <cstddef>
#include <glm/vec4.hpp>
#include <set>
#include <string>
#include <utility>

#include "server/model/dissection.h"
#include "server/model/patches.h"
#include "server/sim/coarse_factor.h"
#include "server/sim/coarse_matrix.h"
#include "server/sim/plan.h"
#include "shaders/slots.h"

namespace clothlab::sim {

namespace {

/// More patches make fewer iterations, but each takes longer, in one work group. At 64x64 vertices 96 instead
/// of 64 spare 3 iterations of 68 and no time (tests/README.md).
constexpr std::uint32_t vertices_a_patch = 40, patches_of_many = 64, vertices_a_patch_of_many = 128;
static_assert(CoarseLevel::most_patches <= group_size);  // implicit_step.comp has a thread for each

std::uint32_t patch_count(std::uint32_t vertices) {
  const std::uint32_t most =
      std::clamp(vertices / vertices_a_patch_of_many, patches_of_many, CoarseLevel::most_patches);
  return std::clamp(vertices / vertices_a_patch, 1U, most);
}

/// For each patch those with which it shares an element.
std::vector<std::vector<std::uint32_t>> neighbours(const model::Model& model,
                                                   const std::vector<std::uint32_t>& patch_of,
                                                   std::uint32_t count) {
  std::vector<std::set<std::uint32_t>> found(count);
  model::each_element(model.elements, [&](const auto& element) {
    for (const std::uint32_t i : element.vertices)
      for (const std::uint32_t j : element.vertices)
        if (patch_of[i] != patch_of[j]) found[patch_of[i]].insert(patch_of[j]);
  });
  std::vector<std::vector<std::uint32_t>> lists;
  for (const std::set<std::uint32_t>& of_patch : found) lists.emplace_back(of_patch.begin(), of_patch.end());
  return lists;
}

/// The lists of shaders/methods/implicit_patches.glsl, one after another. A work group has a slot for each
/// patch of which it has vertices, for its part of the patch's sum.
struct Lists {
  std::vector<std::uint32_t> words;
  std::vector<std::pair<const char*, GLint>> first;  ///< where each list begins
  std::uint32_t slots = 0;
  std::size_t shares = 0;  ///< where those of the vertices begin

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
  lists.shares = lists.words.size();
  lists.add("shares_in_patch", std::vector<std::uint32_t>((patch_modes - 1) * patch_of.size()));
  return lists;
}

/// Lists of the dissection: for each patch its group; for each group its first unknown of all and of its own,
/// the end of its own, where its rows and columns begin, and 1 more than the group above.
void add_tree(Lists& lists, const model::Dissection& dissection, const FactorLayout& layout) {
  std::vector<std::uint32_t> group_of, groups;
  for (std::uint32_t k = 0; k < dissection.groups.size(); ++k) {
    const model::Dissection::Group& group = dissection.groups[k];
    group_of.insert(group_of.end(), group.end - group.begin, k);
    for (const std::uint32_t place : {group.first, group.begin, group.end})
      groups.push_back(place * static_cast<std::uint32_t>(patch_unknowns));
    groups.push_back(layout.rows[k]);
    groups.push_back(layout.columns[k]);
    groups.push_back(static_cast<std::uint32_t>(group.parent + 1));
  }
  lists.add("group_of", group_of);
  lists.add("tree", groups);
}

std::vector<glm::vec4> downloaded(const gl::TextureBuffer& source) {
  std::vector<glm::vec4> vectors(source.buffer.bytes() / sizeof(glm::vec4));
  source.buffer.download(vectors.data(), source.buffer.bytes());
  return vectors;
}

}  // namespace

struct CoarseLevel::Parts {
  std::uint32_t count;
  CoarseMatrix matrix;
  Lists lists;
  FactorLayout layout;
  gl::TextureBuffer words, factor, sums, vectors;

  Parts(std::vector<std::uint32_t> patch_of, std::uint32_t patches, const model::Dissection& dissection)
      : count(patches),
        matrix(dissection, patch_of),
        lists(lists_of(patch_of, patches)),
        layout(factor_layout(dissection)) {
    add_tree(lists, dissection, layout);
    const auto texels = [](std::size_t number) {
      return gl::TextureBuffer(gl::Buffer(number * sizeof(glm::vec4)), GL_RGBA32F);
    };
    words = {gl::Buffer(lists.words), GL_R32UI};
    factor = texels(layout.texels);
    sums = texels(std::size_t{1 + patch_modes} * lists.slots);
    vectors = texels(std::size_t{3 * patch_modes} * count);
  }
};

CoarseLevel::CoarseLevel(const model::Model& model) {
  const std::uint32_t count = patch_count(model.vertex_count());
  std::vector<std::uint32_t> patch_of = model::patches(model, count);
  const model::Dissection dissection = model::dissect(neighbours(model, patch_of, count));
  for (std::uint32_t& patch : patch_of) patch = dissection.places[patch];
  parts_ = std::make_unique<Parts>(std::move(patch_of), count, dissection);
}

CoarseLevel::~CoarseLevel() = default;
CoarseLevel::CoarseLevel(CoarseLevel&&) noexcept = default;
CoarseLevel& CoarseLevel::operator=(CoarseLevel&&) noexcept = default;

void CoarseLevel::set_lists(const gl::Program& program) const {
  for (const auto& [name, first] : parts_->lists.first) program.set(name, first);
  program.set("patch_count", static_cast<GLint>(parts_->count));
}

void CoarseLevel::set_parameters(const model::Model& model, const scene::Scene& scene) {
  parts_->matrix.set_parameters(model, scene);
  std::vector<float> shares;
  for (const Shares& of_vertex : parts_->matrix.shares())
    for (std::size_t mode = 1; mode < patch_modes; ++mode)
      shares.push_back(static_cast<float>(of_vertex[mode]));
  parts_->words.buffer.upload(shares.data(), shares.size() * sizeof(float),
                              parts_->lists.shares * sizeof(float));
}

void CoarseLevel::set_dt(double dt) {
  parts_->matrix.set_dt(dt);
}

void CoarseLevel::prepare(const FineLevel& fine, bool contacts) {
  parts_->matrix.make(downloaded(fine.position),
                      contacts ? downloaded(fine.constraint) : std::vector<glm::vec4>());
  for (const PressingPair& pair : fine.pressing) parts_->matrix.add_pair(pair);
  // A cloth that blows up may leave no definite matrix: then block Jacobi works alone.
  const PatchMatrix& matrix = parts_->matrix.matrix();
  const std::vector<float> texels = laid_out(matrix.inverse_factor(), matrix.dissection(), parts_->layout);
  parts_->factor.buffer.upload(texels.data(), texels.size() * sizeof(float));
}

void CoarseLevel::bind() const {
  parts_->words.bind(unit_patch_lists);
  parts_->factor.bind(unit_coarse_factor);
  parts_->sums.bind(unit_patch_sums);
  parts_->vectors.bind(unit_coarse_vectors);
  parts_->sums.buffer.bind_storage(slot_patch_sums);
}

void CoarseLevel::bind_vectors() const {
  parts_->vectors.buffer.bind_storage(slot_coarse_vectors);
}

}  // namespace clothlab::sim
