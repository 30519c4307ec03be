// The chart of speed against accuracy of one scene. Each point is a method with a time step and a number of
// iterations; it has errors against the double-precision reference, and a cost of stepping.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/control.h"
#include "server/lab/measure/setting.h"

namespace clothlab::lab {

/// The quantity that an error is measured in. Each error is a share, so that 0.01 is one percent.
enum class Axis {
  position,  ///< RMS distance of the vertices to the reference at the horizon, over the cloth's size
  energy,    ///< RMS error of the total energy over the samples, over the largest kinetic + elastic energy
  strain,    ///< error of the largest strain at any sample time, over the reference's largest strain
  rest,      ///< RMS distance to the shape of rest, over the cloth's size, after settling in thick air
};
inline constexpr std::array all_axes{Axis::position, Axis::energy, Axis::strain, Axis::rest};
const char* name(Axis axis);  ///< "position", "energy", "strain" or "rest"
constexpr std::size_t index(Axis axis) {
  return static_cast<std::size_t>(axis);
}
std::optional<Axis> axis_of(const std::string& name);

/// The errors of one run [Axis]; none: not known.
using Errors = std::array<std::optional<double>, all_axes.size()>;

/// The error of one pixel, as a share of the cloth's size, where the cloth fills the 720 lines of a picture.
inline constexpr double one_pixel = 1.0 / 720;
/// The cost of stepping that takes as long as the motion that it simulates [ms per simulated second].
inline constexpr double real_time = 1000.0;

struct Cost {
  double median = 0, minimum = 0;  ///< stepping alone [ms per simulated second]
  int runs = 0;                    ///< number of timed runs, without the warm-up
  /// The interval that holds the true median with a chance of 98 % [ms per simulated second]; infinite: too
  /// few runs. It does not cover later changes of the machine's speed.
  double low = 0, high = std::numeric_limits<double>::infinity();
};

struct Point {
  Setting setting;
  Errors error;
  std::optional<double> largest_position_error;  ///< largest at any sample time up to the horizon
  /// Bounds of the largest position error at any step, see LargestError; only a Choice fills them in.
  std::optional<double> error_low, error_high;
  std::optional<Cost> cost;
  std::optional<double> blew_up_at;  ///< [s]; a point that blew up has no errors
  /// Of the run's last step, see sim::Convergence: a share, and [m]; none: the method does not iterate.
  std::optional<double> residual, step_error;
  std::optional<double> dt_over_limit;  ///< dt over its sharp limit about the rest shape; none: no limit
};

/// A method, or the shorter steps of a method, that are not on the chart, and why.
struct LeftOut {
  scene::Method method = scene::Method::symplectic_euler;
  std::optional<double> dt;  ///< longest step left out [s]; none: the whole method
  std::optional<int> iterations;
  std::string reason;
};

/// What is known about an axis before any point is measured.
struct AxisFacts {
  bool available = false;
  std::string reason;                     ///< why it is not available, and what can be done about it
  std::optional<double> reference_error;  ///< error of the reference itself
  std::optional<double> float32_floor;    ///< distance of RK4 on the GPU to RK4 in double precision, same dt
};

struct Chart {
  std::string scene;     ///< the scene's name
  std::string renderer;  ///< the GL renderer that ran the points
  Origin origin{};
  double size = 0;             ///< the cloth's largest extent at rest [m]
  double time = 0;             ///< simulated time of a point at most, from the start [s]
  double horizon = 0;          ///< positions can be compared until this time [s]; 0: never
  std::string horizon_reason;  ///< how the horizon was found, in a sentence
  /// The scene's own setting, with dt fitted to the sample times; the first point if its method is asked for.
  Setting present;
  std::array<AxisFacts, all_axes.size()> axes;
  std::vector<Point> points;  ///< in the order in which they were measured
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;  ///< for the user, whole sentences
  bool complete = false;           ///< false while the chart is being measured, and if it was cancelled
};

/// Positions, or else the first axis that has errors. None: no axis has.
std::optional<Axis> first_with_errors(const Chart& chart);

struct ChartRequest {
  std::vector<scene::Method> methods;  ///< empty: all that suit the scene
  std::vector<int> iterations;         ///< empty: 1, 4, 16 for methods that sweep; 1, 4 for implicit Euler
  std::optional<double> time;          ///< simulated time [s]; none: 1
  double budget = 120;                 ///< wall time of the chart [s]; points that do not fit are left out
};

/// Measures the chart of a scene. Needs a current GL context. Error: the scene cannot be built, GL, or
/// cancelled before the first point; a chart cancelled later is returned with the points that it has.
Result<Chart> chart(const scene::Scene& scene, const ChartRequest& request, const Control<Chart>& control);

}  // namespace clothlab::lab
