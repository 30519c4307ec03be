#include "server/cli/lab_tables.h"

#include <algorithm>
#include <cstddef>
#include <iostream>
#include <nlohmann/json.hpp>

#include "server/base/text.h"

namespace clothlab::cli {

void print_table(const std::vector<std::vector<std::string>>& rows) {
  // Counts characters, not bytes: "×" and "⁻" are several bytes long but one column wide.
  const auto columns_of = [](const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
  };
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (column == widths.size()) widths.push_back(0);
      widths[column] = std::max(widths[column], columns_of(row[column]));
    }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t column = 0; column < row.size(); ++column) {
      line += row[column];
      if (column + 1 < row.size()) line.append(widths[column] - columns_of(row[column]) + 2, ' ');
    }
    std::cout << line << "\n";
  }
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& words : notes)
    if (!words.empty()) std::cout << "note: " << words << "\n";
}

void print_heading(const std::string& what, double time, const std::string& renderer, bool complete) {
  std::cout << what << ", " << with_significant_digits(time, 6) << " s simulated on " << renderer
            << (complete ? "" : ", NOT COMPLETE") << "\n";
}

std::string set_options(const lab::Setting& setting) {
  std::string options;
  const nlohmann::json patch = lab::patch(setting);
  for (const auto& [key, value] : patch.at("solver").items())
    options += (options.empty() ? "--set /solver/" : " --set /solver/") + key + "=" +
               (value.is_string() ? value.get<std::string>() : value.dump());
  return options;
}

}  // namespace clothlab::cli
