// Times as text.
#pragma once

#include <chrono>
#include <string>

namespace clothlab {

/// In UTC, to the millisecond (RFC 3339): "2026-01-31T12:00:00.000Z".
std::string utc_text(std::chrono::system_clock::time_point time);

}  // namespace clothlab
