#include "server/model/dress.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <set>

#include "server/base/pieces.h"
#include "server/base/text.h"
#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "server/model/dress_memory.h"
#include "server/model/skin.h"
#include "server/model/untangle.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

constexpr double most_of_edge = 0.25;      // what a vertex moves in a step, over the mean edge
constexpr double settling_of_edge = 0.05;  // the same while lengths settle
constexpr double moved_of_edge = 0.01;     // a vertex that moved less is not counted
constexpr int most_put_back = 8;           // rounds of vertices that would cross, in a step of settling
/// Lengths have settled once the sum of squared strains falls by less than this share of it in a step.
constexpr double settled = 0.02;

/// A tangle of more is undone part by part.
constexpr CrossingLimits looked_at{20000, 20000};

class Dressing {
 public:
  Dressing(const Model& model, const scene::Scene& scene, const std::vector<std::uint8_t>& led_out)
      : cloth_(model, led_out),
        start_(cloth_.x),
        bodies_(as_floats(body_positions(model, 0.0))),
        among_cloths_(scene.collides(scene::ContactKind::surface)),
        clearance_(among_cloths_ ? std::min(scene.self_collision->thickness, cloth_.mean_edge())
                                 : 0.1 * cloth_.mean_edge()),
        skin_(model, scene, bodies_, clearance_),
        surfaces_(surfaces_of(model, Bodies::meshes)) {
    surfaces_.among_cloths = among_cloths_;
  }

  /// Leads out in at most so many steps.
  Dressed run(std::size_t steps) {
    skin_.choose_sides(cloth_);
    std::size_t step = 0;
    for (; step < steps; ++step)
      if (lead_out()) break;
    const bool done = step < steps || lead_out();
    const double needed = static_cast<double>(step) / dress_steps_per_second;
    for (; done && step < steps; ++step)
      if (!settle()) break;
    Dressed dressed;
    dressed.done = done;
    dressed.seconds = needed;
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const double way = glm::distance(start_[i], cloth_.x[i]);
      if (!(way > moved_of_edge * cloth_.mean_edge())) continue;
      ++dressed.vertices;
      dressed.farthest = std::max(dressed.farthest, way);
    }
    return dressed;
  }
  const std::vector<dvec3>& places() const { return cloth_.x; }

 private:
  std::vector<Crossing> crossings() const {
    std::vector<dvec3> x = as_floats(cloth_.x);
    x.insert(x.end(), bodies_.begin(), bodies_.end());
    return find_crossings(surfaces_, x, looked_at).first;
  }

  /// One step. True if there is nothing to lead out.
  bool lead_out() {
    between_pieces();
    const std::vector<Crossing> found = crossings();
    std::vector<Demand> demands;
    const std::size_t inside = skin_.demand_outside(cloth_, demands);
    if (found.empty() && inside == 0) return true;
    const double most = most_of_edge * cloth_.mean_edge();
    if (among_cloths_) demand_untangled(cloth_, found, clearance_, most, demands);
    skin_.demand_apart(cloth_, found, demands);
    cloth_.relax(demands, most);
    return false;
  }

  /// One step of cloth that crosses nothing. False if it came to rest.
  bool settle() {
    between_pieces();
    const std::vector<dvec3> before = cloth_.x;
    const double strain = cloth_.squared_strain();
    std::vector<Demand> demands;
    skin_.demand_outside(cloth_, demands);
    const double most = settling_of_edge * cloth_.mean_edge();
    if (among_cloths_) demand_untangled(cloth_, {}, clearance_, most, demands);
    cloth_.relax(demands, most);
    bool clean = false;
    for (int round = 0; !clean && round < most_put_back; ++round) {
      std::set<Index> back;
      for (const Crossing& each : crossings())
        for (const Index vertex :
             {each.edge[0], each.edge[1], each.triangle[0], each.triangle[1], each.triangle[2]})
          if (vertex < cloth_.x.size() && cloth_.x[vertex] != before[vertex]) back.insert(vertex);
      for (const Index vertex : back) cloth_.x[vertex] = before[vertex];
      clean = back.empty();
    }
    std::vector<Demand> unused;
    if (!clean || skin_.demand_outside(cloth_, unused) > 0) {
      cloth_.x = before;
      return false;
    }
    return cloth_.squared_strain() < (1.0 - settled) * strain;
  }

  DressCloth cloth_;
  const std::vector<dvec3> start_;
  const std::vector<dvec3> bodies_;
  const bool among_cloths_;
  const double clearance_;
  Skin skin_;
  Surfaces surfaces_;
};

}  // namespace

void dress(Model& model, const scene::Scene& scene) {
  static DressMemory memory;
  std::vector<std::uint8_t> led_out;
  double seconds = 0.0;
  for (const scene::Cloth& cloth : scene.cloths) {
    const auto* dress = std::get_if<scene::Dress>(&cloth.start);
    led_out.push_back(dress != nullptr);
    if (dress) seconds = std::max(seconds, dress->seconds);
  }
  if (seconds == 0.0) return;
  const auto steps = static_cast<std::size_t>(std::ceil(seconds * dress_steps_per_second));
  const std::string key = dress_key(model, scene, led_out, steps);
  std::optional<DressMemory::Found> found = memory.find(key);
  if (!found) {
    Dressing dressing(model, scene, led_out);
    const Dressed dressed = dressing.run(steps);
    found = DressMemory::Found{key, dressed, dressing.places()};
    memory.keep(*found);
  }
  model.dressed = found->dressed;
  model.start_position = std::move(found->places);
}

std::string dressed_note(const Model& model) {
  if (!model.dressed) return {};
  const auto& [vertices, farthest, seconds, done] = *model.dressed;
  if (!done)
    return formatted("after %.3g s of leading out, cloth is still in a solid: give \"dress\" more seconds",
                     seconds);
  if (vertices == 0) return "the start crosses nothing: no cloth was led out";
  return formatted("cloth was led out at the start in %.3g s: %u %s moved, the farthest by %.3g mm", seconds,
                   vertices, vertices == 1 ? "vertex" : "vertices", 1000.0 * farthest);
}

}  // namespace clothlab::model
