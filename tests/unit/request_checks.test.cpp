// Accept-Encoding, as RFC 7231 (5.3.4) reads it.
#include "server/net/request_checks.h"

#include "tests/catch.h"

using clothlab::net::Coding;
using clothlab::net::preferred_coding;

TEST_CASE(
    "gzip is sent to who names it, or takes anything, with a weight above zero and not below identity's") {
  for (const char* accepts :
       {"gzip", "GZIP", "x-gzip", "br, gzip", "deflate;q=0.3,gzip;q=0.001", "*", "gzip;q=1.0",
        "gzip ; q=0.5 , br", "identity;q=0, *", "identity;q=0.2, gzip;q=0.2", "gzip;Q=0.5", "br;q=0, *;q=0.1",
        "gzip;level=9;q=1"})
    CHECK(preferred_coding(accepts, false) == Coding::gzip);
  for (const char* accepts : {"", "gzip;q=0", "gzip;q=0.000", "gzip; q=0", "*;q=0", "br, gzip;q=0, *",
                              "identity", "br", "notgzip", "gzipped", "gzip;q=0.5, identity", "identity;q=0",
                              "gzip;q=", "gzip;q=x", "gzip;q=2", "gzip;q=-1", "gzip;q=nan", ";;,,", "q=1"})
    CHECK(preferred_coding(accepts, false) == Coding::identity);
}

TEST_CASE("brotli is sent, if it is there, to who names it and likes nothing better") {
  for (const char* accepts :
       {"br", "gzip, deflate, br", "BR;q=0.5, gzip;q=0.5", "br;q=0.1, gzip;q=0", "br, *"})
    CHECK(preferred_coding(accepts, true) == Coding::brotli);
  for (const char* accepts : {"gzip", "*", "br;q=0, gzip", "br;q=0.4, gzip;q=0.5"})
    CHECK(preferred_coding(accepts, true) == Coding::gzip);
  for (const char* accepts : {"", "br;q=0", "br;q=0.5, identity", "bro"})
    CHECK(preferred_coding(accepts, true) == Coding::identity);
}
