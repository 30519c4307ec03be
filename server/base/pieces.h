// Long work on a processor, such as building a scene of a million vertices, is done in pieces. Between them
// the thread that does it can show that it lives, and can give the work up.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>

namespace clothlab {

/// Thrown between two pieces of work that is given up. It must not have changed anything yet.
struct GivenUp : std::exception {
  const char* what() const noexcept override { return "the work was given up"; }
};

/// Called between two pieces, of some 10 ms each where that can be. Calls the watch of this thread, if it has
/// one. Throws GivenUp.
void between_pieces();

/// Counts what a loop does, and calls `between_pieces` now and then.
class Pieces {
 public:
  void next() {
    if (++done_ % 4096 == 0) between_pieces();
  }

 private:
  std::size_t done_ = 0;
};

/// While it lives, `watch` is called between the pieces of what its thread does. Not nested.
class PieceWatch {
 public:
  explicit PieceWatch(std::function<void()> watch);
  ~PieceWatch();
  PieceWatch(const PieceWatch&) = delete;
  PieceWatch& operator=(const PieceWatch&) = delete;
};

/// While one lives, the work of this thread may be given up, unless a Whole lives too.
class MayGiveUp {
 public:
  MayGiveUp();
  ~MayGiveUp();
  MayGiveUp(const MayGiveUp&) = delete;
  MayGiveUp& operator=(const MayGiveUp&) = delete;
};

/// What a thread does while one lives is done as a whole: it replaces what is there.
class Whole {
 public:
  Whole();
  ~Whole();
  Whole(const Whole&) = delete;
  Whole& operator=(const Whole&) = delete;
};

/// True if the work under way on this thread may be given up now. A watch that throws GivenUp asks first.
bool may_give_up();

}  // namespace clothlab
