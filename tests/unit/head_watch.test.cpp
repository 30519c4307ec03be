// What libwebsockets gets to read of the heads of requests.
#include "server/net/head_watch.h"

#include <string>

#include "tests/catch.h"

using namespace clothlab::net;

namespace {

/// The bytes passed on, if they come in pieces of this size.
std::string passed(HeadWatch& watch, const std::string& bytes, std::size_t piece = 1000) {
  std::string all;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    std::string part = bytes.substr(at, piece);
    const std::size_t size = part.size();
    part.resize(size + 100);
    all += part.substr(0, watch.filter(reinterpret_cast<unsigned char*>(part.data()), size, part.size()));
  }
  return all;
}

}  // namespace

TEST_CASE("known headers and strange ones pass unchanged, in any number of requests and pieces") {
  const std::string head =
      "GET /x HTTP/1.1\r\nHost: a:80\r\nSec-WebSocket-Key: x\r\nX-Other: y\r\nAccept: */*\r\nCookie:\r\n\r\n"
      "GET / HTTP/1.0\nHost: a\n\n";
  for (const std::size_t piece : {1u, 2u, 3u, 7u, 1000u}) {
    HeadWatch watch;
    CHECK(passed(watch, head + head, piece) == head + head);
    CHECK_FALSE(watch.malformed());
    CHECK_FALSE(watch.hurried());
  }
}

TEST_CASE("a name that only begins a known one becomes one that begins none") {
  HeadWatch watch;
  CHECK(passed(watch, "GET / HTTP/1.1\r\nX-Auth: 1\r\nif:2\r\nPut-It: 3\r\n\r\n") ==
        "GET / HTTP/1.1\r\nX-Aut!: 1\r\ni!:2\r\nPu!-It: 3\r\n\r\n");
  CHECK_FALSE(watch.malformed());
  HeadWatch one_by_one;  // the name's last letter has been read
  CHECK(passed(one_by_one, "GET / HTTP/1.1\r\nX-Auth: 1\r\n\r\n", 1) ==
        "GET / HTTP/1.1\r\nX-Auth!: 1\r\n\r\n");
}

TEST_CASE("a line without a colon becomes a header that nobody knows, and is told") {
  HeadWatch watch;
  CHECK(passed(watch, "GET / HTTP/1.1\r\nHost\r\n\r\n") == "GET / HTTP/1.1\r\nHos!:\n\r\n");
  CHECK(watch.malformed());
}

TEST_CASE("what comes after a head that asks for another protocol is told, whatever it ends in") {
  const std::string head = "GET /ws HTTP/1.1\r\nupgrade: websocket\r\n\r\n";
  for (const char* more : {"x", "\r\n\r\n", "\x81\x05hello\r\n\r\n", "GET / HTTP/1.1\r\n\r\n"}) {
    HeadWatch watch;
    CHECK(passed(watch, head) == head);
    CHECK_FALSE(watch.hurried());
    passed(watch, more);
    CHECK(watch.hurried());
  }
}
