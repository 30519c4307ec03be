// What a server and its relays say to each other, as pure functions: wants, subjects, leases and rates,
// headers.
#include "server/relay/audience.h"
#include "server/stream/frame.h"
#include "tests/catch.h"

namespace clothlab {

namespace {

using relay::form_count;
using stream::Encoding;

constexpr std::int64_t second = 1'000'000;

}  // namespace

TEST_CASE("a want reads back as it was written, and what is none is refused") {
  relay::Want want{"r-1", 3, {}, {"origin", 1u << 20, 5}};
  want.rates[0] = 0.5;
  want.rates[form_count - 1] = 120;
  const auto read = relay::read_want(relay::text_of(want));
  REQUIRE(read);
  CHECK(read->relay == want.relay);
  CHECK(read->viewers == 3);
  CHECK(read->rates == want.rates);
  CHECK(read->known.origin == "origin");
  CHECK(read->known.revision == 1u << 20);
  CHECK(read->known.topology == 5);
  for (const char* wrong : {"", "{", "3", R"({"relay":1})", R"({"forms":{"q16":-1}})", R"({"forms":[1]})",
                            R"({"forms":{"q16":1e999}})", R"({"known":{"revision":"x"}})"})
    CHECK(!relay::read_want(wrong));
  CHECK(!relay::read_want(std::string(1 << 20, ' ') + "{}"));
  CHECK(relay::read_want("{}"));
  CHECK(!relay::read_want(R"({"known":)" + std::string(5000, '[') + std::string(5000, ']') + "}"));
  const auto greedy = relay::read_want(R"({"viewers":2000000000,"forms":{"q16":1e300}})");
  REQUIRE(greedy);
  CHECK(greedy->viewers == relay::most_viewers);
  CHECK(greedy->rates[stream::Form(Encoding::q16).index()] == relay::most_rate);
}

TEST_CASE("subjects name the session, the encoding and the field") {
  CHECK(relay::frame_subject("a-b", Encoding::q16) == "clothlab.a-b.q16");
  CHECK(relay::frame_subject("s", {Encoding::c16, stream::Field::speed}) == "clothlab.s.c16.speed");
  CHECK(relay::session_of("clothlab.a-b.q16") == "a-b");
  CHECK(relay::session_of("other.a.q16").empty());
}

TEST_CASE("what all relays want is the most that any of them wants, until its lease ends") {
  relay::Audience audience;
  const std::size_t q16 = stream::Form(Encoding::q16).index(), f32 = stream::Form(Encoding::f32).index();
  relay::Want a{"a", 2, {}, {}}, b{"b", 3, {}, {}};
  a.rates[q16] = 30;
  b.rates[q16] = 60;
  b.rates[f32] = 5;
  CHECK(audience.heard(a, 0)[q16]);
  CHECK(audience.heard(b, 0)[q16]);  // new to this relay
  CHECK(!audience.heard(b, 10)[q16]);
  CHECK(audience.viewers() == 5);
  CHECK(audience.rates()[q16] == 60);
  audience.heard(a, 2 * second);
  CHECK(!audience.forget_silent(3 * second));
  CHECK(audience.forget_silent(4 * second));
  CHECK(audience.rates()[q16] == 30);
  CHECK(audience.rates()[f32] == 0);
  CHECK(audience.viewers() == 2);
  a.viewers = 0;  // as a script may say that only wants frames
  audience.heard(a, 4 * second);
  CHECK(audience.viewers() == 1);
  audience.heard({"a", 0, {}, {}}, 4 * second);  // it says goodbye
  CHECK(audience.empty());
}

TEST_CASE("frames are due at the rate that is wanted, each once, and the last one is not lost") {
  relay::Audience audience;
  relay::Want want{"a", 1, {}, {}};
  want.rates[stream::Form(Encoding::q16).index()] = 10;
  audience.heard(want, 0);
  int sent = 0;
  std::uint32_t frame = 0;
  for (std::int64_t now = 0; now < second; now += second / 60)
    sent += audience.due(Encoding::q16, ++frame, now) ? 1 : 0;
  CHECK(sent == 10);
  CHECK(audience.due(Encoding::q16, frame, 2 * second));
  CHECK(!audience.due(Encoding::q16, frame, 3 * second));
  CHECK(!audience.due(Encoding::f32, frame, 3 * second));
  want.relay = "b";  // another relay needs the frame that the first has
  audience.heard(want, 3 * second);
  CHECK(audience.due(Encoding::q16, frame, 3 * second));
}

TEST_CASE(
    "a header reads back as it was written, and a message that is not whole or of another kind is none") {
  constexpr std::size_t payload = 3;
  stream::Header written;
  written.topology_revision = 4;
  written.sequence = 9;
  written.payload_bytes = payload;
  std::vector<std::uint8_t> frame(stream::header_bytes + payload);
  stream::write_header(written, frame.data());
  const auto header = stream::read_header(frame.data(), frame.size());
  REQUIRE(header);
  CHECK(header->kind == stream::MessageKind::frame);
  CHECK(header->encoding == Encoding::q16);
  CHECK(header->topology_revision == 4);
  CHECK(header->sequence == 9);
  for (std::size_t size = 0; size < frame.size(); ++size) CHECK(!stream::read_header(frame.data(), size));
  for (const std::size_t at : {0u, 1u})
    for (const std::uint8_t wrong : {std::uint8_t{3}, std::uint8_t{255}}) {
      std::vector<std::uint8_t> bytes = frame;
      bytes[at] = wrong;
      CHECK(!stream::read_header(bytes.data(), bytes.size()));
    }
}

}  // namespace clothlab
