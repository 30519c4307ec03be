// Accept-Encoding, as RFC 7231 (5.3.4) reads it.
#include "server/net/request_checks.h"

#include "tests/catch.h"

using clothlab::net::prefers_gzip;

TEST_CASE(
    "gzip is sent to who names it, or takes anything, with a weight above zero and not below identity's") {
  for (const char* accepts :
       {"gzip", "GZIP", "x-gzip", "br, gzip", "deflate;q=0.3,gzip;q=0.001", "*", "gzip;q=1.0",
        "gzip ; q=0.5 , br", "identity;q=0, *", "identity;q=0.2, gzip;q=0.2", "gzip;Q=0.5", "br;q=0, *;q=0.1",
        "gzip;level=9;q=1"})
    CHECK(prefers_gzip(accepts));
  for (const char* accepts : {"", "gzip;q=0", "gzip;q=0.000", "gzip; q=0", "*;q=0", "br, gzip;q=0, *",
                              "identity", "br", "notgzip", "gzipped", "gzip;q=0.5, identity", "identity;q=0",
                              "gzip;q=", "gzip;q=x", "gzip;q=2", "gzip;q=-1", "gzip;q=nan", ";;,,", "q=1"})
    CHECK_FALSE(prefers_gzip(accepts));
}
