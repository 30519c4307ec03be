// Which of a client's bytes are passed on to libwebsockets.
#include "server/net/frame_watch.h"

#include <cstddef>
#include <string>

#include "tests/catch.h"

using namespace clothlab::net;

namespace {

std::string frame(int opcode, std::size_t payload, bool masked) {
  const unsigned mask = masked ? 0x80 : 0;
  std::string bytes(1, static_cast<char>(0x80 | opcode));
  const auto put = [&](std::size_t value) { bytes += static_cast<char>(value); };
  if (payload < 126) put(mask | payload);
  if (payload >= 126 && payload < 65536) put(mask | 126), put(payload >> 8), put(payload & 255);
  if (payload >= 65536) {
    put(mask | 127);
    for (int shift = 56; shift >= 0; shift -= 8) put(payload >> shift & 255);
  }
  return bytes + (masked ? "mask" : "") +
         std::string(payload, '\x01');  // as payload these bytes are heads of unmasked frames
}

/// The bytes passed on, if they come in pieces of this size.
std::string passed(FrameWatch& watch, const std::string& bytes, std::size_t piece) {
  std::string all, part(1000000, '\0');
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const std::size_t size = bytes.copy(part.data(), piece, at);
    all.append(part, 0, watch.filter(reinterpret_cast<unsigned char*>(part.data()), size, part.size()));
  }
  return all;
}

}  // namespace

TEST_CASE("masked frames of every length pass unchanged, however they are cut into pieces") {
  std::string bytes;
  for (const std::size_t payload : {0u, 1u, 125u, 126u, 127u, 65535u, 65536u, 100000u})
    bytes += frame(1, payload, true);
  for (const std::size_t piece : {1u, 2u, 3u, 7u, 1000u, 1000000u}) {
    FrameWatch watch;
    CHECK(passed(watch, bytes, piece) == bytes);
    CHECK_FALSE(watch.fault());
  }
}

TEST_CASE("an unmasked frame and all that follows is replaced by empty masked frames") {
  for (const std::size_t payload : {0u, 5u, 126u, 70000u}) {
    for (const std::size_t piece : {1u, 2u, 3u, 7u, 1000000u}) {
      const std::string good = frame(1, 200, true);
      const std::string all = good + frame(1, payload, false) + frame(1, 10, true) + "anything";
      FrameWatch watch;
      const std::string seen = passed(watch, all, piece);
      CHECK(watch.fault());
      REQUIRE(seen.size() >= good.size() + 6);
      CHECK(seen.substr(0, good.size()) == good);
      for (std::size_t at = good.size(); at < seen.size(); at += 6)
        CHECK(seen.substr(at, 6) ==
              std::string(at == good.size() ? "\x81" : "\x8A") + std::string("\x80\0\0\0\0", 5));
    }
  }
}

TEST_CASE("each fault of a frame's first two bytes is found, and nothing of it is passed on") {
  const auto fault = [](const std::string& bytes) {
    FrameWatch watch;
    const std::string seen = passed(watch, bytes, 1000000);
    CHECK(seen == (watch.fault() ? std::string("\x8A\x80\0\0\0\0", 6) : bytes));
    return std::string(watch.fault() ? watch.fault() : "");
  };
  CHECK(fault("\xC1\x80mask").find("reserved bit") != std::string::npos);
  CHECK(fault("\x83\x80mask").find("opcode") != std::string::npos);
  CHECK(fault("\x8B\x80mask").find("opcode") != std::string::npos);
  CHECK(fault(std::string("\x09\x80mask", 6)).find("one piece") != std::string::npos);
  CHECK(fault("\x80\x80mask").find("continuation") != std::string::npos);
  CHECK(fault(std::string("\x01\x80mask\x89\x80mask\x00\x80mask\x80\x80mask\x82\x80mask", 30)).empty());
  FrameWatch within, long_ping;
  CHECK(passed(within, "\x01\x80mask\x81\x80mask", 100).size() == 12);
  CHECK(std::string(within.fault()).find("a message ends") != std::string::npos);
  CHECK(passed(long_ping, frame(9, 126, true), 1000).substr(0, 6) == std::string("\x89\x80\0\0\0\0", 6));
  CHECK(std::string(long_ping.fault()).find("125 bytes") != std::string::npos);
}

TEST_CASE("a replacement is never longer than the room there is") {
  FrameWatch watch;
  unsigned char data[3] = {0x81, 0x01, 'x'};
  CHECK(watch.filter(data, 3, 3) == 3);
  unsigned char more[2] = {1, 2};
  CHECK(watch.filter(more, 2, 2) == 2);
}
