// Which addresses count as one for limits on connections and wrong tokens.
#include "server/net/request_headers.h"
#include "tests/catch.h"

using clothlab::net::network_of;

TEST_CASE("an IPv4 address counts alone, an IPv6 one with its network of 64 bits") {
  CHECK(network_of("192.0.2.7") == "192.0.2.7");
  CHECK(network_of("2001:db8:1:2:3:4:5:6") == "2001:db8:1:2::/64");
  CHECK(network_of("2001:db8:1:2::1") == network_of("2001:db8:1:2:ffff::"));
  CHECK(network_of("2001:db8:1:3::1") != network_of("2001:db8:1:2::1"));
  CHECK(network_of("::1") == "::/64");
  CHECK(network_of("") == "");
}
