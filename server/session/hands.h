// Who holds the cloth: the hands of all clients, each on a vertex, with the place where it would have it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "server/session/command.h"
#include "server/session/refusal.h"
#include "server/sim/hands.h"
#include "server/sim/simulation.h"

namespace clothlab::session {

/// A hand as clients are told of it.
struct HandAt {
  std::uint64_t by = 0;  ///< the client's number
  int hand = 0;
  std::uint32_t cloth = 0, vertex = 0;  ///< vertex of the cloth
  model::dvec3 target{0.0};             ///< [m]
};

class Hands {
 public:
  static constexpr std::size_t most = 64;  ///< of all clients together

  bool empty() const { return hands_.empty(); }
  /// Puts a client's hand on a vertex; lets go of what this hand held before. Waits for the GPU. Refused: no
  /// such vertex, a pinned one, or too many hands.
  std::optional<Refusal> start(std::uint64_t by, const GrabStart& start, sim::Simulation& simulation);
  /// False: the client's hand holds nothing.
  bool move(std::uint64_t by, const GrabMove& move);
  bool end(std::uint64_t by, int hand) { return hands_.erase({by, hand}) > 0; }
  /// Ends all hands of a client; false: it had none.
  bool end_all(std::uint64_t by);
  void clear() { hands_.clear(); }

  std::vector<sim::Hand> for_simulation() const;
  std::vector<HandAt> told() const;
  double force() const;  ///< the most that all hands together pull with [N]
  double reach() const;  ///< the largest of model::Hold [m]

 private:
  struct Held {
    HandAt at;
    std::shared_ptr<const model::Hold> hold;
  };
  std::map<std::pair<std::uint64_t, int>, Held> hands_;
};

}  // namespace clothlab::session
