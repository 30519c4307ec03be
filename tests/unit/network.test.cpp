// Which addresses count as one for limits on connections and wrong tokens.
#include "server/net/request_headers.h"
#include "tests/catch.h"

using clothlab::net::network_of;
using clothlab::net::plain_address;

TEST_CASE("an IPv4 address counts alone, an IPv6 one with its network of 64 bits") {
  CHECK(network_of("192.0.2.7") == "192.0.2.7");
  CHECK(network_of("2001:db8:1:2:3:4:5:6") == "2001:db8:1:2::/64");
  CHECK(network_of("2001:db8:1:2::1") == network_of("2001:db8:1:2:ffff::"));
  CHECK(network_of("2001:db8:1:3::1") != network_of("2001:db8:1:2::1"));
  CHECK(network_of("::1") == "::/64");
  CHECK(network_of("") == "");
}

TEST_CASE("an IPv4 address within IPv6 counts as itself, alone") {
  CHECK(network_of("::ffff:192.0.2.7") == "192.0.2.7");
  CHECK(network_of("::ffff:c000:208") == "192.0.2.8");
}

TEST_CASE("an address has one form, with or without a port, brackets and zeros") {
  for (const char* text :
       {"192.0.2.7", " 192.0.2.7", "192.0.2.7:80", "::ffff:192.0.2.7", "[::ffff:c000:207]:1"})
    CHECK(plain_address(text) == "192.0.2.7");
  for (const char* text : {"2001:db8::1", "2001:0DB8:0::1", "[2001:db8::1]", "[2001:db8::1]:443"})
    CHECK(plain_address(text) == "2001:db8::1");
  for (const char* text : {"", ":", "unknown", "192.0.2.7:", "192.0.2.7:x", "192.0.2", "[192.0.2.7]", "[::1",
                           "::1]", "[::1]x", "[::1]:", "::1:x"})
    CHECK(plain_address(text) == "");
}
