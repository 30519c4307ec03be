// All points of a sweep in one table.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/sweep/folder.h"

namespace clothlab::sweep {

struct Table {
  std::string name;                         ///< the sweep's
  std::vector<std::string> axes;            ///< columns of the points' values
  std::vector<std::string> columns;         ///< axes, then results, in the order in which they first appear
  std::vector<std::vector<json>> rows;      ///< [point that is done][column]; null: not measured
  std::vector<std::size_t> points_of_rows;  ///< [row]: which point of the plan it is
  std::size_t points = 0, missing = 0;      ///< of the plan; not done
};

/// Reads the results that are there.
Table table_of(const Folder& folder, const Plan& plan);

/// RFC 4180, but with plain line feeds. A value that is null is an empty field.
std::string csv(const Table& table);
json to_json(const Table& table);
/// The most points that a browser draws without becoming slow.
inline constexpr std::size_t most_rows_of_page = 20'000;
/// A page, complete in one file, that draws any two columns against each other, with links to `pictures`,
/// which are files beside it. Error: too many points, or the web page has not been built.
Result<std::string> page(const Table& table, const std::vector<std::string>& pictures);

}  // namespace clothlab::sweep
