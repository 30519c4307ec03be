#include "server/base/log_bound.h"

#include <string>

namespace clothlab {

namespace {
constexpr std::int64_t second = 1'000'000;
}

void LogBound::log(std::int64_t now, const std::vector<LogField>& fields) {
  tell_rest(now);
  if (lines_ == 0) begun_ = now;
  if (++lines_ <= most_a_second) clothlab::log(level_, event_, fields);
}

void LogBound::tell_rest(std::int64_t now) {
  if (lines_ == 0 || now - begun_ < second) return;
  if (const int left_out = lines_ - most_a_second; left_out > 0)
    clothlab::log(level_, event_, {{"why", "and " + std::to_string(left_out) + " lines more"}});
  lines_ = 0;
}

}  // namespace clothlab
