#include "server/base/text.h"

#include <cstdarg>
#include <cstdio>

namespace clothlab {

std::string formatted(const char* form, ...) {
  std::va_list values, again;
  va_start(values, form);
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, form, values);
  va_end(values);
  std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(text.data(), text.size() + 1, form, again);
  va_end(again);
  return text;
}

std::string with_significant_digits(double value, int digits) {
  return formatted("%.*g", digits, value);
}

std::string percent(double share) {
  return with_significant_digits(100.0 * share, 3) + " %";
}

}  // namespace clothlab
