#include "server/sim/work.h"

#include <array>
#include <new>

namespace clothlab::sim {

namespace {

/// Coroutine frames that a thread has freed, kept to be used again. A step has only a few frames at a time.
class Frames {
 public:
  ~Frames() {
    for (const Block& block : blocks_) ::operator delete(block.memory);
  }
  void* take(std::size_t bytes) {
    for (Block& block : blocks_)
      if (block.memory && block.bytes == bytes) return std::exchange(block.memory, nullptr);
    return ::operator new(bytes);
  }
  void give(void* memory, std::size_t bytes) {
    for (Block& block : blocks_)
      if (!block.memory) {
        block = {memory, bytes};
        return;
      }
    ::operator delete(memory);
  }

 private:
  struct Block {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };
  std::array<Block, 16> blocks_{};
};

thread_local Frames frames;

}  // namespace

void* Work::promise_type::operator new(std::size_t bytes) {
  return frames.take(bytes);
}

void Work::promise_type::operator delete(void* frame, std::size_t bytes) {
  frames.give(frame, bytes);
}

}  // namespace clothlab::sim
