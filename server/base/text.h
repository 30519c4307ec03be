// Formats numbers for messages to users.
#pragma once

#include <string>

namespace clothlab {

/// Returns the text that printf would print.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* form, ...);

/// `value` with at most `digits` significant digits, trailing zeros left out.
std::string with_significant_digits(double value, int digits);

/// A share in percent, with three significant digits: "3.4 %".
std::string percent(double share);

}  // namespace clothlab
