// Numbers in words that users read.
#pragma once

#include <string>

namespace clothlab {

/// What printf would print.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* form, ...);

/// With this many significant digits, trailing zeros left out.
std::string significant(double value, int digits);

}  // namespace clothlab
