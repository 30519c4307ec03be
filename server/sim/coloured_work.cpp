#include "server/sim/coloured_work.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "server/base/pieces.h"
#include "server/base/text.h"
#include "server/model/constraint_gains.h"

namespace clothlab::sim {

namespace {

bool pinned(const model::Model& model, std::uint32_t vertex) {
  return model.pin_motion[vertex] != model::not_pinned;
}

/// Adds a function that visits the items of `all` for which `wanted(item)` is true. Colours that are left
/// without items are removed.
template <class Wanted>
void add(Visits& visits, const std::string& function, const model::Colouring& all, Wanted wanted) {
  if (visits.offsets.empty()) visits.offsets.push_back(0);
  const std::uint32_t first = visits.colours();
  for (std::uint32_t colour = 0; colour < all.colours(); ++colour) {
    between_pieces();
    for (std::uint32_t k = all.offsets[colour]; k < all.offsets[colour + 1]; ++k)
      if (wanted(all.order[k])) visits.order.push_back(all.order[k]);
    if (visits.order.size() > visits.offsets.back())
      visits.offsets.push_back(static_cast<std::uint32_t>(visits.order.size()));
  }
  visits.functions.push_back({function, first, visits.colours()});
}

/// The items of one law's visits: first and end in the order of all.
struct Items {
  std::uint32_t first = 0, end = 0;
  std::size_t count() const { return end - first; }
};

template <class Law>
Items items(const Visits& visits) {
  const Visits::Function& function = visits.functions[elements::law_number<Law, elements::SweptLaws>];
  return {visits.offsets[function.first_colour], visits.offsets[function.end_colour]};
}

template <class Law>
std::array<Words, elements::visit_texels<Law>> visit(const model::Element<Law>& element,
                                                     const elements::ConstraintGains& gains) {
  std::array<Words, elements::visit_texels<Law>> texels{};
  std::size_t at = 0;
  for (const std::uint32_t vertex : element.vertices) put(texels, at, vertex);
  const auto numbers = elements::numbers(element.law);
  for (std::size_t k = 0; k < elements::Facts<Law>::visit_numbers; ++k) put(texels, at, word(numbers[k]));
  for (const double gain : {gains.stretch, gains.damping, gains.memory}) put(texels, at, word(gain));
  return texels;
}

}  // namespace

Visits visited_elements(const model::Model& model, const scene::Scene& scene) {
  const auto colours = model::colour_elements(model, scene);
  Visits visits;
  model.elements.each_swept([&]<class Law>(const model::Batch<Law>& batch) {
    add(visits, std::string("visit_") + elements::Facts<Law>::name,
        colours[elements::law_number<Law, elements::SweptLaws>], [&](std::uint32_t element) {
          const auto& vertices = batch[element].vertices;
          return std::any_of(vertices.begin(), vertices.end(),
                             [&](std::uint32_t vertex) { return !pinned(model, vertex); });
        });
  });
  return visits;
}

Visits visited_vertices(const model::Model& model, const scene::Scene& scene) {
  Visits visits;
  add(visits, "visit_vertex", model::colour_vertices(model, scene),
      [&](std::uint32_t vertex) { return !pinned(model, vertex); });
  return visits;
}

std::vector<Words> visit_list(const Visits& visits, const model::Model& model, const scene::Scene& scene) {
  std::vector<Words> list;
  const double mobility = model::mobility(scene);
  model.elements.each_swept([&]<class Law>(const model::Batch<Law>& batch) {
    const Items of_law = items<Law>(visits);
    Pieces pieces;
    for (std::uint32_t item = of_law.first; item < of_law.end; ++item) {
      pieces.next();
      const auto& element = batch[visits.order[item]];
      double inverse_mass = 0.0;
      for (const std::uint32_t vertex : element.vertices)
        if (!pinned(model, vertex)) inverse_mass += mobility / model.mass[vertex];
      const auto texels = visit(element, model::constraint_gains(scene.solver, element.law, inverse_mass));
      list.insert(list.end(), texels.begin(), texels.end());
    }
  });
  return list;
}

std::size_t remembered_pushes(const Visits& visits) {
  std::size_t pushes = 0;
  elements::each_law<elements::SweptLaws>([&]<class Law>(std::type_identity<Law>) {
    pushes += items<Law>(visits).count() * (elements::corners<Law> - 1);
  });
  return pushes;
}

gl::Defines visit_defines(const Visits& visits, bool elements) {
  std::string each;
  unsigned number = 0;
  for (const Visits::Function& function : visits.functions)
    if (function.visits()) each += formatted("sweep(%s, %u) ", function.name.c_str(), number++);
  gl::Defines defines{{"EACH_VISIT(sweep)", each}, {"VISIT_ROOM", std::to_string(std::max(number, 1U))}};
  if (!elements) return defines;
  std::string swept;
  elements::each_law<elements::SweptLaws>([&]<class Law>(std::type_identity<Law>) {
    const std::string name = elements::Facts<Law>::name;
    if (items<Law>(visits).count() > 0) swept += name + " ";
    for (const auto& [fact, value] : {std::pair{"_CORNERS", elements::corners<Law>},
                                      {"_VISIT_NUMBERS", elements::Facts<Law>::visit_numbers},
                                      {"_VISIT_TEXELS", elements::visit_texels<Law>}})
      defines.emplace_back(name + fact, std::to_string(value));
  });
  defines.emplace_back("SWEPT_LAWS", swept);
  return defines;
}

void set_visits(const gl::Program& program, const Visits& visits, bool elements) {
  std::vector<GLint> colours;
  for (const Visits::Function& function : visits.functions) {
    if (!function.visits()) continue;
    colours.push_back(static_cast<GLint>(function.first_colour));
    colours.push_back(static_cast<GLint>(function.end_colour));
  }
  glProgramUniform2iv(program.id(), program.location("colours_of"), static_cast<GLsizei>(colours.size() / 2),
                      colours.data());
  if (!elements) return;
  std::size_t texel = 0, push = 0;
  elements::each_law<elements::SweptLaws>([&]<class Law>(std::type_identity<Law>) {
    const Items of_law = items<Law>(visits);
    glProgramUniform3i(program.id(), program.location(std::string("first_of_") + elements::Facts<Law>::name),
                       static_cast<GLint>(of_law.first), static_cast<GLint>(texel), static_cast<GLint>(push));
    texel += of_law.count() * elements::visit_texels<Law>;
    push += of_law.count() * (elements::corners<Law> - 1);
  });
}

}  // namespace clothlab::sim
