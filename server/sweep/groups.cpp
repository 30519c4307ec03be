#include "server/sweep/groups.h"

#include "server/base/text.h"
#include "server/lab/draw/plot.h"
#include "server/scene/method.h"

namespace clothlab::sweep {

namespace {

std::string in_words(const json& label) {
  if (label.is_string()) return label.get<std::string>();
  return label.is_number() ? with_significant_digits(label.get<double>(), 6) : label.dump();
}

}  // namespace

Cells::Cells(const Table& table) : table_(table) {
  for (std::size_t c = 0; c < table.columns.size(); ++c) column_of_[table.columns[c]] = c;
}

const json& Cells::at(std::size_t row, const std::string& column) const {
  static const json nothing;
  const auto found = column_of_.find(column);
  return found == column_of_.end() ? nothing : table_.rows[row][found->second];
}

std::optional<double> Cells::number(std::size_t row, const std::string& column) const {
  const json& value = at(row, column);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::string Cells::text(std::size_t row, const std::string& column) const {
  const json& value = at(row, column);
  return value.is_string() ? value.get<std::string>() : "";
}

std::optional<lab::Setting> Cells::setting(std::size_t row) const {
  const std::optional<scene::Method> method = scene::method_of(text(row, "method"));
  const std::optional<double> dt = number(row, "dt_s");
  if (!method || !dt || !at(row, "refused").is_null()) return std::nullopt;
  lab::Setting setting;
  setting.method = *method;
  setting.dt = *dt;
  if (scene::iterates(*method))
    setting.iterations = static_cast<int>(number(row, "iterations").value_or(setting.iterations));
  if (scene::solves(*method)) setting.tolerance = number(row, "tolerance").value_or(setting.tolerance);
  return setting;
}

std::vector<Group> groups_of(const Plan& plan, const Table& table, const std::set<std::size_t>& free) {
  std::map<std::vector<std::size_t>, Group> groups;
  std::size_t points = 1;
  for (const std::size_t axis : free) points *= plan.axes[axis].values.size();
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<std::size_t> places = plan.places(table.points_of_rows[row]);
    for (const std::size_t axis : free) places[axis] = 0;
    Group& group = groups[places];
    group.rows.push_back(row);
    if (group.rows.size() > 1) continue;
    group.points = points;
    for (std::size_t axis = 0; axis < plan.axes.size(); ++axis)
      if (!free.contains(axis) && plan.axes[axis].values.size() > 1)
        group.words += (group.words.empty() ? "" : ", ") + plan.axes[axis].name + " " +
                       in_words(plan.axes[axis].values[places[axis]].label);
  }
  std::vector<Group> all;
  for (auto& [places, group] : groups) all.push_back(std::move(group));
  return all;
}

std::string title_of(const Plan& plan, const Group& group) {
  std::string title = plan.name;
  const std::string& scene = plan.base.scene.name;
  if (!scene.empty() && scene != title) title += " (" + scene + ")";
  return group.words.empty() ? title : title + ", " + group.words;
}

std::string renderer_of(const Cells& cells, const Group& group, std::vector<std::string>& notes) {
  std::set<std::string> all;
  for (const std::size_t row : group.rows)
    if (const std::string renderer = cells.text(row, "renderer"); !renderer.empty()) all.insert(renderer);
  if (all.size() < 2) return all.empty() ? "" : *all.begin();
  std::string words;
  for (const std::string& renderer : all) words += (words.empty() ? "" : "; ") + renderer;
  notes.push_back("Measured on several devices: " + words + ".");
  return "several devices";
}

void note_absent(const Group& group, std::size_t refused, std::vector<std::string>& notes) {
  if (group.rows.size() < group.points)
    notes.push_back(lab::count(group.points - group.rows.size(), "point is", "points are") +
                    " not measured yet.");
  if (refused > 0)
    notes.push_back(lab::count(refused, "point is", "points are") +
                    " not here: the values make no valid scene.");
}

}  // namespace clothlab::sweep
