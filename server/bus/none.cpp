// In place of nats.cpp where the library was not found at build time.
#include "server/bus/bus.h"

namespace clothlab::bus {

Result<std::unique_ptr<Bus>> connect(const std::string& url, const std::string&, std::function<void()>,
                                     std::size_t) {
  return Error{url, "this program was built without a client library for NATS",
               "install libnats-dev, and build again"};
}

std::string library() {
  return {};
}

}  // namespace clothlab::bus
