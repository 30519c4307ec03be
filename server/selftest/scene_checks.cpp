// Short runs against the truth, and against themselves.
#include <algorithm>

#include "server/base/text.h"
#include "server/reference/trajectory.h"
#include "server/selftest/checks.h"
#include "server/selftest/rounding.h"

namespace clothlab::selftest {

namespace {

/// Half of the last digit of the kept places, which each of three coordinates may be off.
constexpr double of_digits = 0.9e-7;

Result<sim::State> end_of(const ShortRun& run) {
  const auto simulation = started(run);
  if (!simulation) return simulation.error();
  (*simulation)->step(static_cast<std::uint32_t>(run.steps));
  return (*simulation)->read_state();
}

}  // namespace

Result<Check> check_scene(const ShortRun& run) {
  const Result<sim::State> end = end_of(run);
  if (!end) return end.error();
  const std::vector<glm::dvec3> found(end->position.begin(), end->position.end());
  const std::string name = "scene: " + run.name;
  if (!run.has_reference) {
    const Result<Places> kept = read_places(run.places_file());
    if (!kept) return kept.error();
    if (kept->position.size() != found.size())
      return Error{
          "server/selftest/places/" + run.places_file(),
          std::to_string(kept->position.size()) + " places for " + std::to_string(found.size()) + " vertices",
          "install Clothlab again"};
    return at_most(name, reference::rms_distance(found, kept->position), kept->allowed, "m",
                   "from the places of a device that does it right");
  }
  const Result<reference::World> world = world_of(run.scene);
  if (!world) return world.error();
  reference::State expected = reference::at_rest(*world);
  for (int n = 0; n < run.steps; ++n) reference::step(*world, expected);
  return at_most(name, reference::rms_distance(found, expected.position),
                 allowed_distance(*world, expected, run.steps), "m", "from the double-precision reference");
}

Result<Places> places_of(const ShortRun& run) {
  const auto simulation = started(run);
  if (!simulation) return simulation.error();
  (*simulation)->step(static_cast<std::uint32_t>(run.steps));
  const sim::State end = (*simulation)->read_state();
  const Result<reference::World> world = world_of(run.scene);
  if (!world) return world.error();
  return Places{of_digits + allowed_distance(*world, **simulation, end, run.steps),
                {end.position.begin(), end.position.end()}};
}

Result<Check> check_repeats(const ShortRun& run) {
  std::vector<std::uint64_t> hashes;
  for (int round = 0; round < 3; ++round) {
    const Result<sim::State> end = end_of(run);
    if (!end) return end.error();
    hashes.push_back(sim::state_hash(*end));
  }
  const bool same = std::equal(hashes.begin() + 1, hashes.end(), hashes.begin());
  std::string found = formatted("%016llx", static_cast<unsigned long long>(hashes[0]));
  for (std::size_t i = 1; i < hashes.size() && !same; ++i)
    found += formatted(", %016llx", static_cast<unsigned long long>(hashes[i]));
  return Check{
      "repeats: " + run.name,
      same,
      found,
      "one hash",
      "",
      same ? "three runs end in the same bits" : "three runs end in different bits: " + found,
      same ? "" : "a recording of a session cannot be replayed exactly here; " + std::string(wrong_device)};
}

}  // namespace clothlab::selftest
