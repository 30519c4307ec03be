#include "server/bus/bus.h"

#include <utility>

namespace clothlab::bus {

Bytes bytes_of(std::string text) {
  const auto owner = std::make_shared<const std::string>(std::move(text));
  return {owner, reinterpret_cast<const std::uint8_t*>(owner->data()), owner->size()};
}

}  // namespace clothlab::bus
