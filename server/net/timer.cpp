#include "server/net/timer.h"

#include <libwebsockets.h>

#include <utility>

namespace clothlab::net {

struct Timer::State {
  lws_sorted_usec_list_t entry{};  ///< first, so that its address is this struct's
  lws* wsi = nullptr;
  std::function<void()> call;
};

Timer::Timer(lws* wsi, std::function<void()> call) : state_(std::make_unique<State>()) {
  state_->wsi = wsi;
  state_->call = std::move(call);
}

Timer::~Timer() {
  lws_sul_cancel(&state_->entry);
}

void Timer::start(std::int64_t after) {
  const auto due = [](lws_sorted_usec_list_t* entry) {
    const std::function<void()> call = reinterpret_cast<State*>(entry)->call;  // it may end the timer
    call();
  };
  lws_sul_schedule(lws_get_context(state_->wsi), 0, &state_->entry, due, after);
}

}  // namespace clothlab::net
