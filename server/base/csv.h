// A field of a CSV file (RFC 4180).
#pragma once

#include <string>

namespace clothlab {

/// `words`, in quotes if they have a comma, a quote or an end of line in them.
std::string csv_field(const std::string& words);

}  // namespace clothlab
