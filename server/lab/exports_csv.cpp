// Results of the lab as CSV (RFC 4180, but with plain line feeds): a header with the units, then one row for
// each point, cell, trial or variant. A field without a finite number is left empty. Each row ends with what
// was measured, on what, and when, so that tables of several measurements can be put together.
#include <array>
#include <cmath>

#include "server/base/csv.h"
#include "server/base/text.h"
#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

class Table {
 public:
  template <class Outcome>
  Table(const Outcome& of, const std::string& header)
      : text_(header + ",scene_hash,device,date"), end_{of.origin.scene_hash, of.renderer, of.origin.date} {}

  Table& row() {
    end_row();
    text_ += '\n';
    first_ = true;
    return *this;
  }
  Table& add(const std::string& words) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += csv_field(words);
    return *this;
  }
  Table& add(const char* words) { return add(std::string(words)); }
  Table& add(double value) { return add(std::isfinite(value) ? with_significant_digits(value, 9) : ""); }
  Table& add(const std::optional<double>& value) { return value ? add(*value) : add(""); }
  Table& add(int value) { return add(std::to_string(value)); }
  Table& add(bool value) { return add(value ? "yes" : "no"); }
  Table& add(const Errors& errors) {
    for (const std::optional<double>& error : errors) add(error);
    return *this;
  }
  Table& add(const std::optional<Cost>& cost) {
    if (!cost) return add("").add("").add("");
    return add(cost->median).add(cost->minimum).add(cost->runs);
  }
  std::string finish() {
    end_row();
    return text_ + "\n";
  }

 private:
  void end_row() {
    if (!first_)
      for (const std::string& words : end_) add(words);
  }

  std::string text_;
  std::array<std::string, 3> end_;  ///< of each row
  bool first_ = true;               ///< the next field is the row's first
};

const std::string errors_header =
    "position_error_over_size,energy_error_share,strain_error_share,rest_error_over_size";
const std::string cost_header = "median_ms_per_simulated_s,minimum_ms_per_simulated_s,timed_runs";

template <class Outcome>
std::string of_points(const Outcome& of, const std::vector<Point>& points) {
  Table table(
      of, "method,dt_s,iterations,linear_tolerance," + errors_header +
              ",largest_position_error_over_size,largest_position_error_low,largest_position_error_high," +
              cost_header + ",blew_up_at_s,residual,error_m,dt_over_limit");
  for (const Point& point : points) {
    const Setting& setting = point.setting;
    table.row().add(scene::name(setting.method)).add(setting.dt);
    iterates(setting.method) ? table.add(setting.iterations) : table.add("");
    solves(setting.method) ? table.add(setting.tolerance) : table.add("");
    table.add(point.error)
        .add(point.largest_position_error)
        .add(point.error_low)
        .add(point.error_high)
        .add(point.cost);
    table.add(point.blew_up_at).add(point.residual).add(point.step_error).add(point.dt_over_limit);
  }
  return table.finish();
}

std::string table_of(const Chart& chart) {
  return of_points(chart, chart.points);
}

std::string table_of(const Choice& choice) {
  return of_points(choice, choice.tried);
}

std::string table_of(const StabilityMap& map) {
  const std::string unit = map.unit.empty() ? "" : " [" + map.unit + "]";
  Table table(map, "method,field,value" + unit +
                       ",dt_s,log10_energy_growth,blew_up,theory_s,held_s,failed_s,disagrees,reason");
  for (const MethodMap& method : map.methods)
    for (const MapColumn& column : method.columns) {
      const auto row = [&](const MapCell* cell) {
        table.row().add(scene::name(method.method)).add(map.field).add(column.value);
        cell ? table.add(cell->dt).add(cell->growth).add(cell->blew_up) : table.add("").add("").add("");
        table.add(column.theory).add(column.held).add(column.failed).add(column.disagrees);
        table.add(column.reason);
      };
      for (const MapCell& cell : column.cells) row(&cell);
      if (column.cells.empty()) row(nullptr);  // a column without trials still has theory's limit
    }
  return table.finish();
}

std::string table_of(const Simplification& simplification) {
  Table table(simplification, "variant,measured,reason," + errors_header + ",change_over_size," +
                                  cost_header +
                                  ",cost_ratio,cost_ratio_low,cost_ratio_high,saves,dt_limit_s,drop,patch");
  const auto row = [&](const Variant& variant) {
    table.row().add(variant.name).add(variant.measured).add(variant.reason).add(variant.error);
    table.add(variant.change).add(variant.cost);
    table.add(variant.cost ? std::optional(variant.cost_ratio.median) : std::nullopt);
    const bool tells = std::isfinite(variant.cost_ratio.high);
    table.add(tells ? std::optional(variant.cost_ratio.low) : std::nullopt);
    table.add(tells ? std::optional(variant.cost_ratio.high) : std::nullopt).add(name(variant.saving));
    table.add(variant.dt_limit).add(variant.recommended_to_drop).add(variant.patch.dump());
  };
  row(simplification.whole);
  for (const Variant& variant : simplification.variants) row(variant);
  if (simplification.drops_several()) row(simplification.recommended);
  return table.finish();
}

std::string table_of(const Comparison& comparison) {
  Table table(comparison, "time_s,rms_m,most_m");
  for (const auto& moment : comparison.moments)
    table.row().add(moment->time).add(moment->rms).add(moment->most);
  return table.finish();
}

}  // namespace

std::string csv(const Outcome& outcome) {
  return std::visit([](const auto& result) { return table_of(result); }, outcome);
}

}  // namespace clothlab::lab
