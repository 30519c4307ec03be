// The lab's results as JSON, CSV and SVG, with made-up results.
#include <iterator>
#include <regex>

#include "server/lab/exports.h"
#include "tests/catch.h"
#include "tests/lab_outcomes.h"

using namespace clothlab;
using namespace clothlab::lab;

namespace {

std::vector<Outcome> all_kinds() {
  return {tests::made_up_chart(), tests::made_up_map(), tests::made_up_choice(),
          tests::made_up_simplification()};
}

std::size_t count_of(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return static_cast<std::size_t>(
      std::distance(std::sregex_iterator(text.begin(), text.end(), regex), std::sregex_iterator()));
}

}  // namespace

TEST_CASE("the JSON of a chart has every number, with its unit in the name") {
  const json chart = to_json(tests::made_up_chart());
  CHECK(chart["kind"] == "chart");
  CHECK(chart["horizon_s"] == 0.42);
  CHECK(chart["lines"]["real_time_ms"] == 1000.0);
  CHECK(chart["present"] ==
        json{{"method", "verlet"}, {"dt_s", 1e-3}, {"iterations", nullptr}, {"tolerance", nullptr}});
  CHECK(chart["axes"]["position"]["float32_floor"] == 3e-6);
  CHECK(chart["axes"]["rest"]["available"] == false);
  const json& point = chart["points"][0];
  CHECK(point["method"] == "verlet");
  CHECK(point["error"]["rest"].is_null());
  CHECK(point["error"]["position"].get<double>() > 5e-3);
  CHECK(point["ms_a_simulated_s"]["runs"] == 3);
  CHECK(point["patch"]["solver"] == json{{"method", "verlet"}, {"dt", 1.6e-3}});
  CHECK(chart["points"][5]["blew_up_at_s"] == 0.03);
  CHECK(chart["points"][5]["ms_a_simulated_s"].is_null());
  CHECK(chart["left_out"][2] == json{{"method", "vbd"},
                                     {"dt_s", nullptr},
                                     {"iterations", nullptr},
                                     {"reason", "no sweep converges <here> & now"}});
}

TEST_CASE("a number that is not finite is null in JSON, in every kind of result") {
  Simplification simplification = tests::made_up_simplification();
  simplification.variants[0].change = std::nan("");
  CHECK(to_json(simplification)["variants"][0]["change"].is_null());
  CHECK(to_json(simplification)["variants"][2]["dt_limit_s"].is_null());
  for (const Outcome& outcome : all_kinds()) {
    const std::string text = to_json(outcome).dump();
    CHECK(json::parse(text) == to_json(outcome));  // nlohmann would write a NaN as null without an error
  }
}

TEST_CASE("a CSV has a row a point, cell, trial or variant, each with as many fields as the header") {
  const std::vector<std::size_t> rows{tests::made_up_chart().points.size(), 9 * 8 + 9 * 3,
                                      tests::made_up_choice().tried.size(), 1 + 5 + 1};
  const std::vector<Outcome> outcomes = all_kinds();
  for (std::size_t kind = 0; kind < outcomes.size(); ++kind) {
    const std::string table = csv(outcomes[kind]);
    CHECK(count_of(table, "\n") == rows[kind] + 1);
    std::size_t fields = 0, start = 0;
    while (start < table.size()) {
      const std::size_t end = table.find('\n', start);
      // Quoted fields may contain commas.
      const std::string bare =
          std::regex_replace(table.substr(start, end - start), std::regex("\"([^\"]|\"\")*\""), "");
      const std::size_t here = count_of(bare, ",");
      if (fields == 0) fields = here;
      CHECK(here == fields);
      start = end + 1;
    }
  }
}

TEST_CASE("a single recommended part is listed once, several together get a row of their own") {
  Simplification simplification = tests::made_up_simplification();
  const auto listed = [&](const std::string& text) {
    return count_of(text, simplification.recommended.name);
  };
  CHECK(listed(csv(simplification)) == 1);
  CHECK(simplification.drops_several());
  simplification.recommended = simplification.variants[0];
  CHECK_FALSE(simplification.drops_several());
  CHECK(listed(csv(simplification)) == 1);
  CHECK(listed(svg(simplification)) == 2);  // its name, and its title
}

TEST_CASE("a saving that timings leave open says so, with its interval, in every form") {
  Simplification simplification = tests::made_up_simplification();
  Variant& open = simplification.variants[1];
  open.cost_ratio = {0.97, 0.85, 1.08};
  open.saving = saving(open.cost_ratio);
  const json variant = to_json(simplification)["variants"][1];
  CHECK(variant["cost_ratio_low"] == 0.85);
  CHECK(variant["cost_ratio_high"] == 1.08);
  CHECK(variant["saves"] == "cannot tell");
  CHECK(csv(simplification).find(",0.97,0.85,1.08,cannot tell,") != std::string::npos);
  CHECK(svg(simplification).find("0.97 [0.85..1.08] of the cost") != std::string::npos);
  CHECK(svg(simplification).find("the noise hides whether it saves 5 %") != std::string::npos);
  open.cost_ratio = {0.97};
  CHECK(to_json(simplification)["variants"][1]["cost_ratio_high"].is_null());
}

TEST_CASE("a picture has a mark for every setting with an error and a cross for each that blew up") {
  const Chart chart = tests::made_up_chart();
  std::size_t blown = 0;
  for (const Point& point : chart.points) blown += point.blew_up_at ? 1 : 0;
  const std::string picture = svg(chart);
  CHECK(count_of(picture, "data-index=\"") == chart.points.size());
  CHECK(count_of(picture, "class=\"mark blown\"") == blown);
  CHECK(picture.find("<title>verlet, dt 1 ms, error 0.002, 60 ms/s, 0.53 of the limit</title>") !=
        std::string::npos);
  CHECK(picture.find("blew up at 0.03 s") != std::string::npos);
  CHECK(picture.find("no sweep converges &lt;here&gt; &amp; now") != std::string::npos);
  // For a missing axis the picture says why; points that blew up are drawn all the same.
  const std::string rest = svg(chart, Axis::rest);
  CHECK(count_of(rest, "data-index=\"") == blown);
  CHECK(rest.find("the cloth does not come to rest") != std::string::npos);
}

TEST_CASE("no picture has a script, a style, or a number that is none") {
  for (const Outcome& outcome : all_kinds())
    for (const Axis axis : all_axes) {
      const std::string picture = svg(outcome, axis);
      CHECK(count_of(picture, "style|<script|nan|inf[^o]|href|url\\(") == 0);
      CHECK(picture.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 "));
      CHECK(picture.ends_with("</svg>\n"));
      // Every element that is opened is closed.
      CHECK(count_of(picture, "<[a-z]") == count_of(picture, "</[a-z]") + count_of(picture, "/>"));
    }
}

TEST_CASE("results without a single point, cell or variant have a picture that says so") {
  for (const Outcome& outcome :
       {Outcome(Chart{}), Outcome(StabilityMap{}), Outcome(Choice{}), Outcome(Simplification{})}) {
    const std::string picture = svg(outcome);
    CHECK(count_of(picture, "nan|inf[^o]") == 0);
    CHECK(picture.ends_with("</svg>\n"));
    CHECK(json::parse(to_json(outcome).dump()).at("complete") == false);
  }
}

TEST_CASE("every dt of a mark can be read back from its place and the root's scales") {
  const Chart chart = tests::made_up_chart();
  const std::string picture = svg(chart);
  const auto number = [&](const std::string& attribute) {
    std::smatch found;
    REQUIRE(std::regex_search(picture, found, std::regex(attribute + "=\"([^\"]*)\"")));
    return std::stod(found[1]);
  };
  const double x0 = number("data-x0"), x1 = number("data-x1"), left = number("data-left"),
               right = number("data-right"), y0 = number("data-y0"), y1 = number("data-y1"),
               top = number("data-top"), bottom = number("data-bottom");
  // The ring of the present setting, verlet at 1 ms, is drawn at its error and cost.
  std::smatch ring;
  REQUIRE(std::regex_search(picture, ring, std::regex("ring present\" cx=\"([^\"]*)\" cy=\"([^\"]*)\"")));
  const double error = x0 * std::pow(x1 / x0, (std::stod(ring[1]) - left) / (right - left));
  const double cost = y0 * std::pow(y1 / y0, (bottom - std::stod(ring[2])) / (bottom - top));
  // Places are written to a hundredth of a unit: 1e-4 of a decade and a half.
  CHECK(error == Approx(*chart.points[1].error[0]).epsilon(1e-3));
  CHECK(cost == Approx(chart.points[1].cost->median).epsilon(1e-3));
}
