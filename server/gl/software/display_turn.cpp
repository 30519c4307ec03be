#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "server/gl/software/displays.h"

namespace clothlab::gl {

namespace {

using Clock = std::chrono::steady_clock;

/// Fifty times what a piece of a step takes while others wait, so that a holder whose thread had to wait for
/// a core keeps its turn.
constexpr std::chrono::milliseconds longest_turn(200);

struct Waiter {
  const DisplayTurn* turn;
  bool begun = false;
  std::condition_variable wake;
};

struct Display {
  std::mutex mutex;
  const DisplayTurn* holder = nullptr;
  Clock::time_point end;  ///< of the holder's turn, if others wait
  std::deque<Waiter*> waiting;

  void begin(const DisplayTurn* turn) {
    holder = turn;
    end = Clock::now() + longest_turn;
  }

  void next() {
    holder = nullptr;
    if (waiting.empty()) return;
    Waiter& first = *waiting.front();
    waiting.pop_front();
    begin(first.turn);
    first.begun = true;
    first.wake.notify_one();
  }
};

Display& display_of(HelperThreads threads) {
  static std::array<Display, 4> displays;
  return displays[static_cast<std::size_t>(threads)];
}

}  // namespace

DisplayTurn::DisplayTurn(HelperThreads threads) : display_(threads) {
  software::check_software("a turn to compute");
  Display& display = display_of(display_);
  std::unique_lock lock(display.mutex);
  if (!display.holder) {
    display.begin(this);
  } else {
    Waiter waiter{this, false, {}};
    display.waiting.push_back(&waiter);
    while (!waiter.begun) {
      waiter.wake.wait_until(lock, display.end);
      if (!waiter.begun && Clock::now() >= display.end) display.next();
    }
  }
  others_ = static_cast<std::uint32_t>(display.waiting.size());
}

DisplayTurn::~DisplayTurn() {
  Display& display = display_of(display_);
  const std::lock_guard lock(display.mutex);
  if (display.holder == this) display.next();
}

std::size_t DisplayTurn::waiting(HelperThreads threads) {
  Display& display = display_of(threads);
  const std::lock_guard lock(display.mutex);
  return display.waiting.size();
}

}  // namespace clothlab::gl
