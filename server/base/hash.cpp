#include "server/base/hash.h"

#include "server/base/text.h"

namespace clothlab {

void Hash::add(const std::string& bytes) {
  for (const char byte : bytes) {
    const auto value = static_cast<std::uint8_t>(byte);
    first_ = (first_ ^ value) * 0x100000001b3ull;
    // A different multiplier, so that bytes that collide in one lane do not collide in the other.
    second_ = (second_ + value + 1) * 0x9e3779b97f4a7c15ull;
    second_ ^= second_ >> 32;
  }
  first_ = (first_ ^ bytes.size()) * 0x100000001b3ull;
  second_ = (second_ ^ bytes.size()) * 0x9e3779b97f4a7c15ull;
}

std::string Hash::text() const {
  return formatted("%016llx%016llx", static_cast<unsigned long long>(first_),
                   static_cast<unsigned long long>(second_));
}

}  // namespace clothlab
