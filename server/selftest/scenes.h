// The short scenes of server/selftest/scenes/: each file has one scene and the runs of it, one for each
// method that it is meant for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"
#include "server/sim/simulation.h"

namespace clothlab::selftest {

/// A hand that pulls at a vertex from the start on.
struct Pull {
  std::uint32_t vertex = 0;
  glm::dvec3 target{0.0};  ///< [m]
};

struct ShortRun {
  std::string name;    ///< "swing, verlet"
  scene::Scene scene;  ///< with the run's method, time step and iterations
  int steps = 0;
  std::optional<Pull> pull;
  /// False: the reference has no such law, so it is compared with places kept in server/selftest/places/.
  bool has_reference = true;
  bool quick = false;  ///< also run by --quick

  /// "swing-verlet.json", in server/selftest/places/
  std::string places_file() const;
};

/// All runs of all files, in the order of the files' names. Error: a file is missing or cannot be read.
Result<std::vector<ShortRun>> short_runs();

/// The run's simulation at its start, with its hand on the cloth. Error: it cannot be made.
Result<std::unique_ptr<sim::Simulation>> started(const ShortRun& run);

}  // namespace clothlab::selftest
