#include "server/sim/solved.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "server/base/text.h"
#include "server/scene/method.h"
#include "server/sim/kernels.h"

namespace clothlab::sim {

namespace {

constexpr std::uint64_t first_measured = 8, rarest_measured = 256;
/// Places are float32: a change below this share of the farthest coordinate is rounding.
constexpr double rounding = 4e-7;

std::vector<glm::vec4> downloaded(const gl::Buffer& places, std::uint32_t count) {
  std::vector<glm::vec4> words(count);
  places.download(words.data(), count * sizeof(glm::vec4));
  return words;
}

/// A ratio nearer to 1 says no more than that the series is long.
constexpr double most_ratio = 0.999;

/// What an iteration changed: its size over all free vertices, and at the one that it moved farthest [m]; the
/// same over the mean edge of the vertex's cloth.
struct Change {
  double rms = 0, most = 0, most_edges = 0;
};

Change change(const std::vector<glm::vec4>& from, const std::vector<glm::vec4>& to,
              const model::Model& model) {
  Change change;
  double sum = 0.0;
  std::size_t free = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i].w == 0.0f) continue;
    const double moved = glm::distance(glm::dvec3(from[i]), glm::dvec3(to[i]));
    sum += moved * moved;
    change.most = std::max(change.most, moved);
    const double edge = model.cloths[model.vertex_cloth[i]].mean_edge_length;
    if (edge > 0.0) change.most_edges = std::max(change.most_edges, moved / edge);
    ++free;
  }
  if (free > 0) change.rms = std::sqrt(sum / static_cast<double>(free));
  return change;
}

/// Measured at the ends of short runs, presets leave up to half of a step's change but move vertices by 0.13
/// of an edge at most, single steps of `funnel` by 0.32; cotton that ten sweeps stretch by 20 % and more
/// instead of 4 % leaves half and more, and mostly moves by 0.4 of an edge and more. Of Newton's steps one is
/// a method of its own, of first order: there is no fault unless a second one comes no nearer.
bool far_from_solved(const Solves& solves, scene::Method method) {
  constexpr double many_gravities = 1.0, many_edges = 0.3;
  const double much = scene::sweeps(method) ? 0.3 : 0.9;
  return solves.undone > many_gravities && solves.edges > many_edges && solves.share > much;
}

double farthest_coordinate(const std::vector<glm::vec4>& places) {
  float farthest = 0.0f;
  for (const glm::vec4& place : places)
    farthest = std::max({farthest, std::abs(place.x), std::abs(place.y), std::abs(place.z)});
  return static_cast<double>(farthest);
}

}  // namespace

bool Solves::often_unsolved() const {
  return unsolved_steps > 0 && 2 * unsolved_steps >= since_first;
}

std::string in_words(const Solves& solves, const scene::Scene& scene) {
  const bool sweeps = scene::sweeps(scene.solver.method);
  const int count = scene.solver.iterations;
  const char* one = sweeps ? "sweep" : "Newton step";
  return formatted(
             "%llu of %llu steps that were measured ended far from solved: in the last one %d %s%s of "
             "%s left out what would move the cloth by %.2g mm more, %.2g of its edges. Stretch, speed and "
             "shape are "
             "then those of the iteration, not of the cloth: ",
             static_cast<unsigned long long>(solves.unsolved_steps),
             static_cast<unsigned long long>(solves.measured), count, one, count == 1 ? "" : "s",
             scene::name(scene.solver.method), 1000.0 * solves.left, solves.edges) +
         (sweeps ? "a smaller dt, more iterations, or the method implicit_euler helps"
                 : "a smaller dt or more iterations helps");
}

bool SolvedMeasure::due(std::uint64_t step) const {
  step -= std::min(first_step_, step);
  if (step < first_measured) return false;
  return step % (step < rarest_measured ? std::bit_floor(step) / 2 : rarest_measured) == 0;
}

Work SolvedMeasure::measure(const StateBuffers& state, Kernels& kernels, const scene::Scene& scene, int row,
                            std::uint64_t step) {
  Integrator& integrator = *kernels.integrator;
  const int iterations = integrator.iterations();
  if (iterations == 0) co_return;
  const int first = std::max(iterations - 1, integrator.fewest_iterations());
  {
    Carrier out = Carrier::to(carried_);
    integrator.carry(out);
  }
  for (int k = 0; k < 3; ++k) {
    trial_.copy_from(state);
    co_await integrator.again(trial_, row, first + k);
    gl::Buffer& end = ends_[static_cast<std::size_t>(k)];
    const gl::Buffer& places = trial_.position().buffer;
    if (end.bytes() != places.bytes()) end = gl::Buffer(places.bytes());
    end.copy_from(places);
    Carrier back = Carrier::from(carried_);
    integrator.carry(back);
  }
  if (kernels.self_collision) kernels.self_collision->give_up_step();
  take(kernels.model, scene, step, first < iterations);
}

/// `has_fewer`: the first of the three has one iteration less than the scene, else as many.
void SolvedMeasure::take(const model::Model& model, const scene::Scene& scene, std::uint64_t step,
                         bool has_fewer) {
  std::array<std::vector<glm::vec4>, 3> ends;
  for (std::size_t k = 0; k < 3; ++k) ends[k] = downloaded(ends_[k], model.vertex_count());
  const Change before = change(ends[0], ends[1], model), after = change(ends[1], ends[2], model);
  const double dt = scene.solver.dt;
  ++solves_.measured;
  solves_.step = step;
  if (!std::isfinite(after.rms)) return;
  const bool rounded = after.most <= rounding * farthest_coordinate(ends[1]);
  solves_.ratio = rounded || before.rms == 0.0 ? 0.0 : after.rms / before.rms;
  const Change& next = has_fewer ? after : before;
  const double all_further = 1.0 / (1.0 - std::min(solves_.ratio, most_ratio));
  solves_.left = next.most * all_further;
  solves_.edges = next.most_edges * all_further;
  solves_.share = std::min(std::pow(solves_.ratio, scene.solver.iterations), 1.0);
  const double pull = std::max(glm::length(scene.gravity), 1.0);
  solves_.undone = rounded ? 0.0 : solves_.left / (dt * dt * pull);
  solves_.unsolved = far_from_solved(solves_, scene.solver.method);
  if (solves_.unsolved) ++solves_.unsolved_steps;
  if (solves_.unsolved_steps > 0) ++solves_.since_first;
}

}  // namespace clothlab::sim
