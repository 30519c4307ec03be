#include "server/sweep/pictures.h"

#include <algorithm>
#include <functional>
#include <set>

#include "server/lab/exports.h"
#include "server/sweep/lab_results.h"

namespace clothlab::sweep {

namespace {

/// Whether an axis changes nothing of a scene but these members of its solver.
bool changes_only(const Axis& axis, const std::set<std::string>& members) {
  const auto allowed = [&](const std::string& place) {
    return place.starts_with("/solver/") && members.contains(place.substr(std::string("/solver/").size()));
  };
  if (!axis.at.empty()) return std::all_of(axis.at.begin(), axis.at.end(), allowed);
  return std::all_of(axis.values.begin(), axis.values.end(), [&](const Value& value) {
    const auto solver = value.patch.find("solver");
    if (value.patch.size() != 1 || solver == value.patch.end() || !solver->is_object()) return false;
    return std::all_of(solver->items().begin(), solver->items().end(),
                       [&](const auto& member) { return members.contains(member.key()); });
  });
}

/// "chart-rows-21.svg": letters, digits, points and dashes, as every file system takes them.
std::string file_name(const std::string& words, std::set<std::string>& taken) {
  constexpr std::size_t most_characters = 120;
  std::string name;
  bool dash = false;
  for (const char c : words.substr(0, most_characters)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.';
    if (plain && dash && !name.empty()) name += '-';
    if (plain) name += c;
    dash = !plain;
  }
  std::string free = name;
  for (int number = 2; !taken.insert(free).second; ++number) free = name + "-" + std::to_string(number);
  return free + ".svg";
}

}  // namespace

Pictures pictures(const Plan& plan, const Table& table) {
  const Cells cells(table);
  Pictures all;
  std::set<std::string> taken;
  const auto draw_all = [&](const std::set<std::size_t>& free, const std::string& kind,
                            const std::function<std::string(const Group&)>& draw) {
    for (const Group& group : groups_of(plan, table, free)) {
      if (all.drawn.size() == most_pictures) {
        ++all.beyond;
        continue;
      }
      all.drawn.push_back({file_name(kind + " " + group.words, taken), draw(group)});
    }
  };
  std::set<std::size_t> of_setting, of_method, of_dt, of_numbers;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    const Axis& axis = plan.axes[a];
    if (axis.values.size() < 2) continue;
    if (changes_only(axis, {"method", "dt", "iterations", "tolerance"})) of_setting.insert(a);
    if (changes_only(axis, {"method"}))
      of_method.insert(a);
    else if (axis.at == std::vector<std::string>{"/solver/dt"})
      of_dt.insert(a);
    else if (!axis.at.empty() && std::all_of(axis.values.begin(), axis.values.end(),
                                             [](const Value& value) { return value.label.is_number(); }))
      of_numbers.insert(a);
  }
  if (plan.quantities.error && plan.quantities.cost && !of_setting.empty())
    draw_all(of_setting, "chart", [&](const Group& group) {
      const lab::Chart chart = lab_chart(plan, cells, group);
      return lab::svg(chart, lab::first_with_errors(chart).value_or(lab::Axis::position));
    });
  if (of_dt.size() != 1) return all;
  for (const std::size_t a : of_numbers) {
    std::set<std::size_t> free = of_method;
    free.insert(*of_dt.begin());
    free.insert(a);
    const Axis& axis = plan.axes[a];
    draw_all(free, of_numbers.size() > 1 ? "map over " + axis.name : "map",
             [&](const Group& group) { return lab::svg(lab_map(plan, cells, group, axis)); });
  }
  return all;
}

}  // namespace clothlab::sweep
