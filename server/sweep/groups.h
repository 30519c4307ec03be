// Points of a sweep that agree on every axis but some: what one picture shows.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/lab/measure/setting.h"
#include "server/sweep/plan.h"
#include "server/sweep/table.h"

namespace clothlab::sweep {

/// The cells of a table, which must outlive this, by the names of its columns.
class Cells {
 public:
  explicit Cells(const Table& table);
  /// Null: no such column, or not measured.
  const json& at(std::size_t row, const std::string& column) const;
  std::optional<double> number(std::size_t row, const std::string& column) const;
  /// Empty: no text.
  std::string text(std::size_t row, const std::string& column) const;
  /// How the point was stepped. None: it is no valid scene.
  std::optional<lab::Setting> setting(std::size_t row) const;

 private:
  const Table& table_;
  std::map<std::string, std::size_t> column_of_;
};

struct Group {
  std::string words;  ///< what its points agree on: "rows 21, fabric denim"; empty: nothing varies
  std::vector<std::size_t> rows;  ///< of the table
  std::size_t points = 0;         ///< of the plan; those that are not done have no row
};

/// The groups of points that may differ on the axes `free` alone, in the order of the plan; none without
/// rows.
std::vector<Group> groups_of(const Plan& plan, const Table& table, const std::set<std::size_t>& free);

/// The sweep's name, the scene's if it is another one, and what the group agrees on.
std::string title_of(const Plan& plan, const Group& group);
/// The device that measured the group's points. If there are several, `notes` get their names.
std::string renderer_of(const Cells& cells, const Group& group, std::vector<std::string>& notes);
/// Adds notes on points that are not done, and on `refused` points, which are no valid scene.
void note_absent(const Group& group, std::size_t refused, std::vector<std::string>& notes);

}  // namespace clothlab::sweep
