#include "server/sim/spring_lists.h"

#include <algorithm>

#include "server/sim/plan.h"

namespace clothlab::sim {

SpringLists spring_lists(const model::Model& model, const scene::Scene& scene) {
  SpringLists lists;
  lists.slices.push_back(0);
  lists.entries.reserve(model.vertex_springs.items.size());
  const std::vector<std::uint32_t>& offsets = model.vertex_springs.offsets;
  for (std::uint32_t first = 0; first < model.vertex_count(); first += group_size) {
    const std::uint32_t last = std::min<std::uint32_t>(first + group_size, model.vertex_count());
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < last; ++i) longest = std::max(longest, offsets[i + 1] - offsets[i]);
    const std::size_t start = lists.entries.size();
    lists.entries.resize(start + std::size_t{longest} * group_size);
    for (std::uint32_t i = first; i < first + group_size; ++i) {
      for (std::uint32_t slot = 0; slot < longest; ++slot) {
        SpringEntry& entry = lists.entries[start + std::size_t{slot} * group_size + (i - first)];
        entry.other = std::min(i, model.vertex_count() - 1);
        if (i >= last || offsets[i] + slot >= offsets[i + 1]) continue;
        const model::Spring& spring = model.springs[model.vertex_springs.items[offsets[i] + slot]];
        const scene::Springs& material = scene.cloths[spring.cloth].material;
        entry = {spring.a == i ? spring.b : spring.a, static_cast<float>(spring.rest_length),
                 static_cast<float>(model::stiffness(material, spring.kind)),
                 static_cast<float>(material.damping)};
      }
    }
    lists.slices.push_back(lists.slices.back() + longest);
  }
  return lists;
}

}  // namespace clothlab::sim
