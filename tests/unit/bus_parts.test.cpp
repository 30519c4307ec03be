// Messages larger than the bus takes at once, in parts.
#include <algorithm>
#include <numeric>

#include "server/bus/parts.h"
#include "tests/catch.h"

using clothlab::bus::part_count;
using clothlab::bus::part_label;
using clothlab::bus::Parts;

namespace {

std::vector<std::uint8_t> some_bytes(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

using Bytes = std::vector<std::uint8_t>;
using Whole = std::optional<Bytes>;

Whole add(Parts& parts, const std::string& label, const std::vector<std::uint8_t>& bytes,
          const std::string& subject = "a") {
  return parts.add(subject, label, bytes.data(), bytes.size());
}

}  // namespace

TEST_CASE("a message in parts of any size is whole again after its last part, and not before") {
  for (const std::size_t size : {0u, 1u, 99u, 100u, 101u, 1000u})
    for (const std::size_t most : {1u, 7u, 100u, 5000u}) {
      const std::vector<std::uint8_t> all = some_bytes(size);
      const std::size_t count = part_count(size, most);
      CHECK(count >= 1);
      CHECK(count * most >= size);
      if (count > Parts::most_parts) continue;
      Parts parts;
      Whole whole;
      for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(!whole);
        const auto from = all.begin() + static_cast<std::ptrdiff_t>(i * most);
        const auto to = all.begin() + static_cast<std::ptrdiff_t>(std::min(size, (i + 1) * most));
        whole = add(parts, count == 1 ? "" : part_label(i + 1, count), {from, to});
      }
      CHECK(whole == all);
    }
}

TEST_CASE("of a message of which a part is missing nothing comes, and the next message is whole") {
  const std::vector<std::uint8_t> bytes = some_bytes(3);
  for (const std::vector<std::string>& labels :
       std::vector<std::vector<std::string>>{{"2/2"},
                                             {"1/3", "3/3"},
                                             {"1/3", "3/3", "3/3"},
                                             {"1/2", "1/2", "1/2"},
                                             {"1/3", "2/2"},
                                             {"1/2", "2/3", "2/2"}}) {
    Parts parts;
    for (const std::string& label : labels) CHECK(!add(parts, label, bytes));
    CHECK(!add(parts, "1/2", bytes));
    CHECK(add(parts, "2/2", bytes)->size() == 6);
  }
}

TEST_CASE("parts of different subjects do not mix") {
  Parts parts;
  CHECK(!add(parts, "1/2", {1}, "a"));
  CHECK(!add(parts, "1/2", {2}, "b"));
  CHECK(add(parts, "", {9}, "c") == Bytes{9});
  CHECK(add(parts, "2/2", {3}, "a") == Bytes{1, 3});
  CHECK(add(parts, "2/2", {4}, "b") == Bytes{2, 4});
}

TEST_CASE("labels that are none drop the message, whatever they are") {
  for (const char* label :
       {"0/2", "3/2", "1", "/", "1/", "/2", "a/b", "1/2x", "-1/2", "1/99999999999999999999", "1/5000"}) {
    Parts parts;
    CHECK(!add(parts, label, {1}));
    CHECK(!add(parts, "2/2", {2}));
  }
}
