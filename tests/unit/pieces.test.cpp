// Long work can be looked at between its pieces, and given up.
#include "server/base/pieces.h"

#include <thread>

#include "tests/catch.h"

using namespace clothlab;

TEST_CASE("work is looked at on its own thread, as long as the watch lives") {
  int looks = 0;
  {
    const PieceWatch watch([&] { ++looks; });
    between_pieces();
    Pieces pieces;
    for (int i = 0; i < 3 * 4096; ++i) pieces.next();
    std::thread([] { between_pieces(); }).join();
  }
  between_pieces();
  CHECK(looks == 4);
}

TEST_CASE("work may be given up where somebody allows it, but not what is done as a whole") {
  CHECK_FALSE(may_give_up());
  const MayGiveUp may;
  CHECK(may_give_up());
  {
    const Whole whole;
    CHECK_FALSE(may_give_up());
  }
  CHECK(may_give_up());
  std::thread([] { CHECK_FALSE(may_give_up()); }).join();
  const PieceWatch watch([] {
    if (may_give_up()) throw GivenUp();
  });
  CHECK_THROWS_AS(between_pieces(), GivenUp);
}
