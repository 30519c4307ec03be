// Speed against accuracy: every method over a range of time steps and iterations on one scene, each point's
// error against the double-precision reference and its cost in stepping.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/control.h"
#include "server/lab/measure/setting.h"

namespace clothlab::lab {

/// What an error is an error of; each a share, so that 0.01 is one percent.
enum class Axis {
  position,  ///< RMS distance of the vertices to the reference at the horizon, over the cloth's size
  energy,    ///< RMS over the sample times of the total energy's error, over the most that ever moved or
             ///< stretched
  strain,    ///< error of the largest strain within the time, over that strain
  rest,      ///< RMS distance to the shape of rest, over the cloth's size, after settling in thick air
};
inline constexpr std::array all_axes{Axis::position, Axis::energy, Axis::strain, Axis::rest};
const char* name(Axis axis);  ///< "position", ...
constexpr std::size_t index(Axis axis) {
  return static_cast<std::size_t>(axis);
}
std::optional<Axis> axis_of(const std::string& name);

/// Errors of one run by Axis; none where it could not be had.
using Errors = std::array<std::optional<double>, all_axes.size()>;

/// One pixel where the cloth fills the 720 lines of a picture, as a share of its size.
inline constexpr double one_pixel = 1.0 / 720;
/// Stepping that takes as long as what it simulates [ms per simulated second].
inline constexpr double real_time = 1000.0;

struct Cost {
  double median = 0, minimum = 0;  ///< stepping alone [ms per simulated second]
  int runs = 0;                    ///< timed, after a warm-up that is not
  /// Where the median lies, as far as these runs tell; infinite: they were too few. The machine may be
  /// another one tomorrow.
  double low = 0, high = std::numeric_limits<double>::infinity();
};

struct Point {
  Setting setting;
  Errors error;
  std::optional<double> largest_position_error;  ///< at any sample time up to the horizon
  /// Of a choice: between what the largest error at any step lies, see LargestError.
  std::optional<double> error_low, error_high;
  std::optional<Cost> cost;
  std::optional<double> blew_up_at;  ///< [s]; it has no errors then
  std::optional<double>
      dt_over_limit;  ///< of the sharp limit about the rest shape; none where nothing limits dt
};

/// What is not on the chart, and why.
struct LeftOut {
  scene::Method method = scene::Method::symplectic_euler;
  std::optional<double> dt;  ///< [s]; none: the whole method
  std::optional<int> iterations;
  std::string reason;
};

/// What there is to know about an axis before any point.
struct AxisFacts {
  bool available = false;
  std::string reason;                     ///< why not, and what can be done about it
  std::optional<double> reference_error;  ///< of the reference itself
  std::optional<double> float32_floor;    ///< RK4 on the GPU against RK4 in double precision, same steps
};

struct Chart {
  std::string scene;           ///< its name
  std::string renderer;        ///< what it ran on
  double size = 0;             ///< the cloth's largest extent at rest [m]
  double time = 0;             ///< simulated by each point, from the start [s]
  double horizon = 0;          ///< of position errors [s]: up to there a perturbed copy stays near; 0: none
  std::string horizon_reason;  ///< how it was found, in a sentence
  Setting present;  ///< the scene's own, its step fitted to the samples; the first point if its method is
                    ///< asked for
  std::array<AxisFacts, all_axes.size()> axes;
  std::vector<Point> points;  ///< in the order in which they were measured
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;  ///< for the user, whole sentences
  bool complete = false;           ///< false while it is being measured and where it was cancelled
};

struct ChartRequest {
  std::vector<scene::Method> methods;  ///< empty: all
  std::vector<int> iterations;  ///< empty: 1, 2, 4, 8, 16 for those that sweep; 1, 4 for implicit Euler
  std::optional<double> time;   ///< [s]; none: 1
  double budget = 120;          ///< wall time for the whole chart [s]; what comes too late is left out
};

/// Needs a current GL context. Error: the scene cannot be built, or cancelled.
Result<Chart> chart(const scene::Scene& scene, const ChartRequest& request, const Control<Chart>& control);

}  // namespace clothlab::lab
