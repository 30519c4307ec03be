// Random scenes of a cloth that is thrown at a body of triangles, and what must hold in them. A seed makes
// the same scene on every machine.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/model/crossings.h"
#include "server/scene/scene.h"
#include "server/sim/simulation.h"

namespace clothlab::test {

struct ThrownCloth {
  scene::Scene scene;
  glm::vec3 velocity{0.0f};  ///< of the cloth at the start [m/s]
  glm::vec3 spin{0.0f};      ///< about its middle [1/s]
  int steps = 0;
  bool plate = false;  ///< the body is an open plate, whose sides can be told apart
  bool moves = false;  ///< the body moves
  std::string words;
};

/// An open plate, a ball or an open bowl of some 100 to 1500 triangles (`heavy`: to 50,000), at rest or in
/// motion; a sheet of soft springs or of cotton, thrown at up to 50 m/s and spun; any method, and steps of
/// 10 us to 1 s (under an explicit method: as long as it may have).
ThrownCloth thrown_cloth(std::uint64_t seed, bool heavy = false);

/// Watches a simulation step by step.
class Watched {
 public:
  Watched(const ThrownCloth& thrown, sim::Simulation& simulation);
  /// After a step: what is wrong, or "". A body that moves may take cloth through itself, and its pairs may
  /// have met, if the simulation has told of it.
  std::string wrong();

 private:
  std::string through_plate(const std::vector<glm::dvec3>& x, const std::vector<glm::dvec3>& body);

  const ThrownCloth& thrown_;
  sim::Simulation& simulation_;
  model::Surfaces surfaces_;
  std::vector<glm::dvec3> in_plate_;  ///< the cloth's places as the plate sees them, a step before [m]
};

}  // namespace clothlab::test
