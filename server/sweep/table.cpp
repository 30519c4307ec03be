#include "server/sweep/table.h"

#include <map>

#include "server/base/csv.h"
#include "server/base/page_template.h"

namespace clothlab::sweep {

namespace {

/// Calls `each` with the name and the value of every number, text and truth value of a result. A member of a
/// member is named with an underscore: "cost_median_ms_per_simulated_s".
template <class Each>
void for_each_value(const Row& value, const std::string& name, const Each& each) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items())
      for_each_value(member, name.empty() ? key : name + "_" + key, each);
  } else if (!value.is_array()) {
    each(name, value);
  }
}

std::string field(const json& value) {
  if (value.is_null()) return "";
  return csv_field(value.is_string() ? value.get<std::string>() : value.dump());
}

void add_row(std::string& text, const std::vector<std::string>& fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) text += ',';
    text += fields[i];
  }
  text += '\n';
}

}  // namespace

Table table_of(const Folder& folder, const Plan& plan) {
  Table table;
  table.name = plan.name;
  table.points = plan.size();
  for (const Axis& axis : plan.axes) table.axes.push_back(axis.name);
  table.columns = table.axes;
  std::map<std::string, std::size_t> column_of;
  for (std::size_t a = 0; a < table.axes.size(); ++a) column_of[table.axes[a]] = a;
  for (std::size_t point = 0; point < table.points; ++point) {
    const std::optional<Row> result = folder.result(plan.id(point));
    if (!result) {
      ++table.missing;
      continue;
    }
    std::vector<json> row(table.columns.size());
    const std::vector<std::size_t> at = plan.places(point);
    for (std::size_t a = 0; a < at.size(); ++a) row[a] = plan.axes[a].values[at[a]].label;
    for_each_value(*result, "", [&](const std::string& name, const Row& value) {
      const auto [found, added] = column_of.emplace(name, table.columns.size());
      if (found->second < table.axes.size()) return;  // an axis has this name: its value is there
      if (added) table.columns.push_back(name);
      if (row.size() <= found->second) row.resize(found->second + 1);
      row[found->second] = value;
    });
    table.rows.push_back(std::move(row));
    table.points_of_rows.push_back(point);
  }
  for (std::vector<json>& row : table.rows) row.resize(table.columns.size());
  return table;
}

std::string csv(const Table& table) {
  std::string text;
  std::vector<std::string> fields;
  for (const std::string& column : table.columns) fields.push_back(csv_field(column));
  add_row(text, fields);
  for (const std::vector<json>& row : table.rows) {
    fields.clear();
    for (const json& value : row) fields.push_back(field(value));
    add_row(text, fields);
  }
  return text;
}

Result<std::string> page(const Table& table, const std::vector<std::string>& pictures) {
  if (table.rows.size() > most_rows_of_page)
    return Error{"the page", std::to_string(table.rows.size()) + " points",
                 "at most " + std::to_string(most_rows_of_page) + "; table.csv has all of them"};
  json content = to_json(table);
  content["pictures"] = pictures;
  std::string data = content.dump(-1, ' ', false, json::error_handler_t::replace);
  // A text in it must not end the element that it is in.
  for (std::size_t at = 0; (at = data.find('<', at)) != std::string::npos;) data.replace(at, 1, "\\u003c");
  return filled_page("sweep.html", {{"@title@", as_html(table.name)}, {"@table@", data}});
}

json to_json(const Table& table) {
  return {{"sweep", table.name},    {"axes", table.axes},       {"columns", table.columns},
          {"points", table.points}, {"missing", table.missing}, {"rows", table.rows}};
}

}  // namespace clothlab::sweep
