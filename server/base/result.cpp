#include "server/base/result.h"

namespace clothlab {

std::string Error::text() const {
  std::string line;
  for (const std::string* part : {&where, &what, &remedy}) {
    if (part->empty()) continue;
    if (!line.empty()) line += part == &remedy ? "; " : ": ";
    line += *part;
  }
  return line;
}

}  // namespace clothlab
