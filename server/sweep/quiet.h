// Whether this program had its cores alone for a while: a time measured beside other work says little.
#pragma once

#include <chrono>
#include <optional>

namespace clothlab::sweep {

class Quiet {
 public:
  /// Starts to watch the cores that this process may use.
  Quiet();

  /// The number of cores, on average since the start, on which other programs worked. None: the operating
  /// system does not say.
  std::optional<double> others() const;

  /// The most work of others beside which a time counts [cores].
  static constexpr double most_others = 0.15;

 private:
  struct Reading {
    std::optional<double> busy;  ///< processor time of these cores, of all programs [s]
    double own = 0;              ///< processor time of this process [s]
    std::chrono::steady_clock::time_point at;
  };
  static Reading read();

  Reading start_;
};

}  // namespace clothlab::sweep
