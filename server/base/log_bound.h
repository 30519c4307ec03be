// A bound for lines that others can cause without end: so many a second, and how many were left out.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/log.h"

namespace clothlab {

/// For one thread.
class LogBound {
 public:
  static constexpr int most_a_second = 10;

  LogBound(LogLevel level, const char* event) : level_(level), event_(event) {}
  /// Writes the line, unless there were ten in this second. `now`: of any clock that never goes back [us].
  void log(std::int64_t now, const std::vector<LogField>& fields);
  /// Tells how many lines were left out, once their second is over. To be called about once a second.
  void tell_rest(std::int64_t now);

 private:
  LogLevel level_;
  const char* event_;
  std::int64_t begun_ = 0;  ///< when the second began that is counted
  int lines_ = 0;           ///< in it, those left out included
};

}  // namespace clothlab
