#include "server/sim/element_lists.h"

#include <algorithm>
#include <bit>

#include "server/sim/plan.h"

namespace clothlab::sim {

namespace {

std::uint32_t word(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

/// The entry of `spring` in the list of the vertex at its `corner`, as kernels read it (Spring_ENTRY in
/// shaders/elements/spring.glsl).
std::array<Words, 1> entry(const model::Spring& spring, std::size_t corner) {
  return {Words{spring.vertices[1 - corner], word(spring.law.rest_length), word(spring.law.stiffness),
                word(spring.law.damping)}};
}
/// An entry that gives no force, to pad a list: all its corners are `vertex` itself.
std::array<Words, 1> padding(const model::Batch<elements::Spring>&, std::uint32_t vertex) {
  return {Words{vertex, 0, 0, 0}};
}

template <class Law>
void add_list(ElementLists& lists, const model::Batch<Law>& batch, std::uint32_t vertex_count) {
  const std::vector<std::uint32_t>& offsets = batch.at_vertex.offsets;
  const auto row = [&] { return static_cast<std::uint32_t>(lists.entries.size() / group_size); };
  for (std::uint32_t first = 0; first < vertex_count; first += group_size) {
    lists.slices.push_back(row());
    const std::uint32_t last = std::min<std::uint32_t>(first + group_size, vertex_count);
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < last; ++i) longest = std::max(longest, offsets[i + 1] - offsets[i]);
    const std::size_t start = lists.entries.size();
    constexpr std::size_t texels = std::tuple_size_v<decltype(padding(batch, 0))>;
    lists.entries.resize(start + longest * texels * group_size);
    const auto put = [&](std::uint32_t lane, std::size_t slot, const std::array<Words, texels>& words) {
      for (std::size_t t = 0; t < texels; ++t)
        lists.entries[start + (slot * texels + t) * group_size + lane] = words[t];
    };
    for (std::uint32_t lane = 0; lane < group_size; ++lane) {
      const std::uint32_t i = std::min(first + lane, vertex_count - 1);
      std::size_t slot = 0;
      if (first + lane < last)
        batch.at(i,
                 [&](const auto& element, std::size_t corner) { put(lane, slot++, entry(element, corner)); });
      while (slot < longest) put(lane, slot++, padding(batch, i));
    }
  }
  lists.slices.push_back(row());
}

}  // namespace

ElementLists element_lists(const model::Model& model) {
  ElementLists lists;
  model.elements.each([&](const auto& batch) {
    lists.entries.reserve(lists.entries.size() + batch.at_vertex.items.size());
    add_list(lists, batch, model.vertex_count());
  });
  return lists;
}

gl::Defines law_defines() {
  return {{"LAWS", "Spring"}, {"Spring_LIST", "0"}};
}

gl::Defines law_defines(const Plan& plan) {
  gl::Defines defines = law_defines();
  if (!plan.springs()) defines.front().second.clear();
  return defines;
}

}  // namespace clothlab::sim
