#include "server/sim/element_lists.h"

#include <algorithm>
#include <bit>
#include <string>
#include <type_traits>
#include <utility>

#include "server/base/pieces.h"
#include "server/sim/plan.h"

namespace clothlab::sim {

namespace {

/// The entry of `element` in the list of the vertex at its `corner`: the other corners, then the law's
/// numbers.
template <class Law>
auto entry(const model::Element<Law>& element, std::size_t corner) {
  constexpr std::size_t corners = elements::corners<Law>;
  std::array<Words, elements::entry_texels<Law>> texels{};
  std::size_t at = 0;
  for (std::size_t other = 1; other < corners; ++other)
    put(texels, at, element.vertices[(corner + other) % corners]);
  for (const double number : elements::numbers(law_at(element, corner))) put(texels, at, word(number));
  return texels;
}

/// An entry that gives no force, to pad a list: all its corners are `vertex` itself, and its numbers are 0.
template <class Law>
auto padding(std::uint32_t vertex) {
  model::Element<Law> element{{}, Law{}};
  element.vertices.fill(vertex);
  return entry(element, 0);
}

template <class Law>
void add_list(ElementLists& lists, const model::Batch<Law>& batch, std::uint32_t vertex_count) {
  const std::vector<std::uint32_t>& offsets = batch.at_vertex.offsets;
  const auto row = [&] { return static_cast<std::uint32_t>(lists.entries.size() / group_size); };
  for (std::uint32_t first = 0; first < vertex_count; first += group_size) {
    between_pieces();
    lists.slices.push_back(row());
    const std::uint32_t last = std::min<std::uint32_t>(first + group_size, vertex_count);
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < last; ++i) longest = std::max(longest, offsets[i + 1] - offsets[i]);
    const std::size_t start = lists.entries.size();
    constexpr std::size_t texels = elements::entry_texels<Law>;
    lists.entries.resize(start + longest * texels * group_size);
    const auto place = [&](std::uint32_t lane, std::size_t slot, const std::array<Words, texels>& words) {
      for (std::size_t t = 0; t < texels; ++t)
        lists.entries[start + (slot * texels + t) * group_size + lane] = words[t];
    };
    for (std::uint32_t lane = 0; lane < group_size; ++lane) {
      const std::uint32_t i = std::min(first + lane, vertex_count - 1);
      std::size_t slot = 0;
      if (first + lane < last)
        batch.at(
            i, [&](const auto& element, std::size_t corner) { place(lane, slot++, entry(element, corner)); });
      while (slot < longest) place(lane, slot++, padding<Law>(i));
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

std::uint32_t word(double number) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(number));
}

gl::Defines law_defines(const LawSet& compiled) {
  gl::Defines defines{{"LAWS", ""}};
  elements::each_law([&]<class Law>(std::type_identity<Law>) {
    using elements::Facts;
    const std::string name = Facts<Law>::name;
    if (compiled[elements::law_number<Law>]) defines.front().second += name + " ";
    for (const auto& [fact, number] : {std::pair{"_LIST", elements::law_number<Law>},
                                       {"_CORNERS", Facts<Law>::corners},
                                       {"_TEXELS", elements::entry_texels<Law>}})
      defines.emplace_back(name + fact, std::to_string(number));
  });
  return defines;
}

}  // namespace clothlab::sim
