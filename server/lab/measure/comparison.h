// Two settings of the same scene, stepped together from the start: where the vertices of each are at the same
// times, and how far apart. The first may be the truth, in double precision, instead.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/control.h"
#include "server/lab/measure/setting.h"
#include "server/scene/document.h"

namespace clothlab::lab {

struct CompareRequest {
  json patch = json::object();  ///< makes B of the scene: RFC 7396 (object) or RFC 6902 (array)
  bool truth = false;           ///< A is the truth about B's scene; else A is the scene as it is
  double time = 5;              ///< to simulate [s]
  int rate = 25;                ///< moments a simulated second
};

/// What a comparison may take in memory: positions of both sides at all moments [bytes].
inline constexpr std::size_t max_comparison_bytes = 32u << 20;
/// The most vertices: one moment of both sides must fit into a message.
inline constexpr std::size_t max_compared_vertices = 65536;

/// Both sides at one time.
struct Moment {
  double time = 0;           ///< [s]
  std::vector<float> a, b;   ///< [vertex][3] positions [m]
  double rms = 0, most = 0;  ///< distance of the vertices of `a` from those of `b` [m]: RMS over all, largest
  std::vector<scene::Collider> colliders;  ///< at this time; empty if none of the scene's moves
};

struct ComparedSide {
  Setting setting;                   ///< of the truth: that of its scene
  std::optional<double> blew_up_at;  ///< [s]; then the comparison ends
  std::string reason;                ///< of the blow-up
};

struct Comparison {
  std::string scene, renderer;
  Origin origin{};
  double time = 0;                ///< simulated by both sides [s]: as asked for, or less
  int rate = 0;                   ///< moments a simulated second
  std::size_t vertices = 0;       ///< of each side
  bool truth = false;             ///< A is the truth
  std::optional<double> horizon;  ///< of the truth: until then positions can be compared [s]
  double reference_error = 0;     ///< the truth's own error at the horizon, RMS [m]
  ComparedSide a, b;
  std::vector<std::shared_ptr<const Moment>> moments;  ///< at 0, 1/rate, 2/rate, ...
  std::vector<std::string> notes;
  bool complete = false;
};

/// Where no step of a side ends at a moment, the side is on the straight line between the steps before and
/// after, which is off by at most an eighth of the acceleration times dt squared. Needs a current GL context.
/// Error: the patch, a patch that changes the mesh, no truth, too much to keep, GL, or cancelled.
Result<Comparison> compare(const scene::Document& document, const CompareRequest& request,
                           const Control<Comparison>& control);

}  // namespace clothlab::lab
