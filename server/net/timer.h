// Calls a function on the service thread, once, after a while.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

struct lws;

namespace clothlab::net {

class Timer {
 public:
  /// For a connection; the timer must end before it.
  Timer(lws* wsi, std::function<void()> call);
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// Calls the function `after` [us] from now; an earlier call that has not come yet is forgotten.
  void start(std::int64_t after);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clothlab::net
