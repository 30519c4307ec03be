// The stability map: where measurement and theory must agree, where they cannot, and what it contains when it
// ends early.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/lab/measure/disagreement.h"
#include "server/lab/measure/stability_map.h"
#include "server/scene/method.h"
#include "tests/scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using lab::MapColumn;
using lab::StabilityMap;
using scene::Method;

namespace {

/// One spring of 16 N/m with 1 kg at its end, omega = 4 / s, as in small_scenes.h. Its amplitude is so small
/// that it is linear until growth is proved.
scene::Document one_spring() {
  return document_of(R"({"version": 1, "name": "one spring", "gravity": [0, 0, 0.016],
    "cloths": [{"mesh": {"grid": {"columns": 2, "rows": 3, "width": 1, "height": 1}}, "mass": {"per_vertex": 1},
                "material": {"structural": 0, "shear": 0, "bend": 16, "damping": 0},
                "pins": [{"at": "edge:row:0"}, {"at": "edge:row:1"}]}]})");
}

/// A cloth that lies still in its plane, except for a pull by 1e-4.
scene::Document grid(double gravity) {
  return document_of(R"({"version": 1, "name": "grid", "gravity": [0, 0, )" + std::to_string(gravity) + R"(],
    "cloths": [{"mesh": {"grid": {"columns": 9, "rows": 7, "width": 0.8, "height": 0.6}}, "mass": {"per_vertex": 0.001},
                "material": {"structural": 100, "shear": 100, "bend": 100, "damping": 0},
                "pins": [{"at": "edge:row:0"}]}]})");
}

StabilityMap map_of(const scene::Document& document, const lab::MapRequest& request) {
  const Result<StabilityMap> map = lab::stability_map(document, request, {});
  INFO((map ? "" : map.error().text()));
  REQUIRE(map);
  CHECK(map->complete);
  return *map;
}

/// The closed form of a method's limit, in 1/omega, at damping ratio z (shaders/README.md).
double closed_form(Method method, double z) {
  if (method == Method::symplectic_euler) return 2 * (std::sqrt(1 + z * z) - z);
  if (method == Method::verlet) return 2 * (std::sqrt(1 + 4 * z * z) - 2 * z);
  return z == 0.0 ? 2.828 : z == 0.5 ? 2.62 : 2.79;
}

/// The bisection's 1 %, and as much for slow growth just beyond the limit.
constexpr double tolerance = 0.02;

}  // namespace

TEST_CASE("on one spring the map's measured boundary and its theory are the closed form, damped or not") {
  const auto context = test::context();
  const StabilityMap map = map_of(
      one_spring(),
      {{Method::symplectic_euler, Method::verlet, Method::rk4}, "/cloths/0/material/damping", 0.0, 8.0, 3});
  CHECK(map.unit == "N s/m");
  CHECK(map.present_value == 0.0);
  REQUIRE(map.methods.size() == 3);
  for (const lab::MethodMap& method : map.methods) {
    REQUIRE(method.columns.size() == 3);
    for (const MapColumn& column : method.columns) {
      const double expected = closed_form(method.method, column.value / 8.0) / 4.0;
      INFO(scene::name(method.method) << ", damping " << column.value << ": " << column.reason);
      REQUIRE(column.held);
      REQUIRE(column.failed);
      CHECK(*column.theory == Approx(expected).epsilon(0.005));
      CHECK(*lab::measured_boundary(column) == Approx(expected).epsilon(tolerance));
      CHECK(*column.failed / *column.held < 1.0101);
      CHECK_FALSE(column.disagrees);
      CHECK(std::is_sorted(column.cells.begin(), column.cells.end(),
                           [](const lab::MapCell& a, const lab::MapCell& b) { return a.dt < b.dt; }));
    }
  }
}

TEST_CASE("on a grid at rest the map's boundary falls with the root of the stiffness, as theory's") {
  const auto context = test::context();
  const StabilityMap map =
      map_of(grid(1.0), {{Method::symplectic_euler, Method::verlet}, "stiffness", 1.0, 100.0, 2});
  for (const lab::MethodMap& method : map.methods) {
    for (const MapColumn& column : method.columns) {
      INFO(scene::name(method.method) << ", stiffness x " << column.value << ": " << column.reason);
      CHECK(*lab::measured_boundary(column) == Approx(*column.theory).epsilon(tolerance));
      CHECK(column.cells.front().growth < 0.1);
      CHECK(column.cells.back().growth > 3.0);
    }
    CHECK(*method.columns[0].theory / *method.columns[1].theory == Approx(10.0).epsilon(0.005));
  }
}

TEST_CASE("where gravity stretches a cloth far the map says that theory is off, and why") {
  const auto context = test::context();
  // 7 rows of 1 g at 9.8 m/s^2 on springs of 0.1 N/m and 0.1 m stretch the uppermost to about 6 times its
  // length. At rest it counts along the columns only; stretched it counts across them, too.
  const StabilityMap map = map_of(grid(9.8), {{Method::symplectic_euler}, "stiffness", 0.001, 1.0, 2});
  const MapColumn &soft = map.methods[0].columns[0], &stiff = map.methods[0].columns[1];
  INFO(soft.reason);
  CHECK(soft.disagrees);
  CHECK(*soft.failed < 0.95 * *soft.theory);
  CHECK(soft.reason.find("it is stretched to") == 0);
  CHECK_FALSE(stiff.disagrees);
  REQUIRE_FALSE(map.notes.empty());
  CHECK(map.notes[0].find("symplectic_euler, stiffness 0.001: the measured limit is 0.") == 0);
}

TEST_CASE("the map says that explicit Euler without damping has no limit, and where its growth shows") {
  const auto context = test::context();
  const StabilityMap map = map_of(one_spring(), {{Method::explicit_euler}, "stiffness", 1.0, 4.0, 2});
  for (const MapColumn& column : map.methods[0].columns) {
    CHECK(*column.theory == 0.0);
    CHECK(column.disagrees);
    CHECK(column.failed);
    CHECK(column.reason.find("without damping no step is stable") == 0);
  }
}

TEST_CASE("methods that no step makes unstable hold at the longest that the map tries") {
  const auto context = test::context();
  const StabilityMap map =
      map_of(grid(9.8), {{Method::implicit_euler, Method::pbd, Method::xpbd, Method::vbd, Method::bdf2},
                         "stiffness",
                         1.0,
                         100.0,
                         2});
  for (const lab::MethodMap& method : map.methods) {
    for (const MapColumn& column : method.columns) {
      INFO(scene::name(method.method));
      CHECK_FALSE(column.theory);
      CHECK_FALSE(column.failed);
      CHECK(*column.held == 0.1);
      CHECK_FALSE(column.disagrees);
    }
  }
}

TEST_CASE("a cancelled map begins nothing more, and what had arrived stays") {
  const auto context = test::context();
  std::stop_source source;
  int begun_after = 0;
  StabilityMap so_far;
  lab::Control<StabilityMap> control;
  control.stop = source.get_token();
  control.arrived = [&](const StabilityMap& map) { so_far = map; };
  control.progress = [&](const lab::Progress& progress) {
    CHECK(progress.done <= progress.total);
    if (source.stop_requested()) ++begun_after;
    if (progress.done >= 1.3) source.request_stop();
  };
  lab::MapRequest request;
  request.methods = {Method::rk4};
  const Result<StabilityMap> map = lab::stability_map(*scene::load_preset("seed"), request, control);
  REQUIRE_FALSE(map);
  CHECK(lab::was_cancelled(map.error()));
  CHECK(begun_after == 0);
  REQUIRE(so_far.methods.size() == 1);
  CHECK(so_far.methods[0].columns.size() == 1);
  CHECK_FALSE(so_far.complete);
}
