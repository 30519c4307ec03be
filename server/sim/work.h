// Work for the GPU that is queued a piece at a time: a coroutine that may stop between its dispatches and is
// resumed later, so that a thread that steps a heavy scene can do other things in between.
#pragma once

#include <chrono>
#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <utility>

namespace clothlab::sim {

/// Limits how much a Work queues before it stops: until a time, and up to a number of places (`may_stop`).
/// Without limits a Work runs to its end.
struct Pace {
  using Clock = std::chrono::steady_clock;

  Clock::time_point until = Clock::time_point::max();
  std::uint32_t most_places = std::numeric_limits<std::uint32_t>::max();  ///< largest number of places
  std::uint32_t passed = 0;                                               ///< places reached so far

  bool limited() const {
    return until != Clock::time_point::max() || most_places != std::numeric_limits<std::uint32_t>::max();
  }
  bool enough() {
    return ++passed >= most_places || (until != Clock::time_point::max() && Clock::now() >= until);
  }
};

/// `co_await may_stop` in a Work marks a place at which the Work stops if its pace has enough. Afterwards the
/// GL bindings may have changed, unless the caller of `resume` restores them (gl::Bindings).
struct MayStop {};
inline constexpr MayStop may_stop;

class [[nodiscard]] Work {
 public:
  struct promise_type;
  using Handle = std::coroutine_handle<promise_type>;

  /// An empty Work, which is done.
  Work() = default;
  Work(Work&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Work& operator=(Work&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Work() {
    if (handle_) handle_.destroy();
  }

  bool done() const { return !handle_ || handle_.done(); }
  /// Continues until `pace` has enough or the work has ended. Throws what the work throws.
  void resume(Pace& pace);

 private:
  struct Awaited;
  explicit Work(Handle handle) : handle_(handle) {}
  Handle handle_ = nullptr;
};

/// A Work can await another Work, which can await a third. All of them share the Chain of the outermost Work,
/// and `resume` of the outermost Work runs the innermost one.
struct Work::promise_type {
  struct Chain {
    Handle innermost = nullptr;
    Pace* pace = nullptr;
    bool stopped = false;
  };
  /// Each step allocates and frees coroutine frames, so freed frames are kept and used again.
  static void* operator new(std::size_t bytes);
  static void operator delete(void* frame, std::size_t bytes);

  Chain own_chain;
  Chain* chain = &own_chain;
  Handle waiting;  ///< the Work that waits for this one to end; null for the outermost
  std::exception_ptr failure;

  Work get_return_object() {
    own_chain.innermost = Handle::from_promise(*this);
    return Work(own_chain.innermost);
  }
  std::suspend_always initial_suspend() noexcept { return {}; }
  std::suspend_always final_suspend() noexcept {
    chain->innermost = waiting;
    return {};
  }
  void return_void() {}
  void unhandled_exception() { failure = std::current_exception(); }

  struct Stop {
    Chain& chain;
    bool await_ready() const { return !chain.pace->enough(); }
    void await_suspend(std::coroutine_handle<>) const { chain.stopped = true; }
    void await_resume() const {}
  };
  Stop await_transform(MayStop) { return {*chain}; }
  Awaited await_transform(Work&& other);
};

struct Work::Awaited {
  Work work;
  bool await_ready() const { return work.done(); }
  void await_suspend(Handle waiting) const {
    promise_type& promise = work.handle_.promise();
    promise.chain = waiting.promise().chain;
    promise.waiting = waiting;
    promise.chain->innermost = work.handle_;
  }
  void await_resume() const {
    if (work.handle_ && work.handle_.promise().failure)
      std::rethrow_exception(work.handle_.promise().failure);
  }
};

inline Work::Awaited Work::promise_type::await_transform(Work&& other) {
  return {std::move(other)};
}

inline void Work::resume(Pace& pace) {
  if (done()) return;
  promise_type& promise = handle_.promise();
  promise.own_chain.pace = &pace;
  promise.own_chain.stopped = false;
  while (!handle_.done() && !promise.own_chain.stopped) promise.own_chain.innermost.resume();
  if (promise.failure) std::rethrow_exception(std::exchange(promise.failure, nullptr));
}

}  // namespace clothlab::sim
