#include "server/base/csv.h"

namespace clothlab {

std::string csv_field(const std::string& words) {
  if (words.find_first_of(",\"\r\n") == std::string::npos) return words;
  std::string quoted(1, '"');
  for (const char character : words) quoted.append(character == '"' ? 2 : 1, character);
  quoted += '"';
  return quoted;
}

}  // namespace clothlab
