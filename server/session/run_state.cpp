#include "server/session/run_state.h"

namespace clothlab::session {

bool RunState::would_play() const {
  const State goes_on_as = diverged() ? before_blow_up_ : state_;
  return goes_on_as != State::paused;
}

bool RunState::play() {
  if (diverged()) return false;
  state_ = State::playing;
  return true;
}

void RunState::pause() {
  (diverged() ? before_blow_up_ : state_) = State::paused;
}

bool RunState::step_by_hand() {
  if (diverged()) return false;
  state_ = State::paused;
  return true;
}

bool RunState::hold() {
  if (!plays()) return false;
  resting_ = state_ == State::asleep;
  state_ = State::held;
  return true;
}

bool RunState::release() {
  State& goes_on_as = diverged() ? before_blow_up_ : state_;
  if (goes_on_as != State::held) return false;
  goes_on_as = at_rest() ? State::asleep : State::playing;
  return true;
}

bool RunState::fall_asleep() {
  if (state_ != State::playing) return false;
  state_ = State::asleep;
  return true;
}

bool RunState::wake() {
  if (!at_rest()) return false;
  if (state_ == State::asleep) state_ = State::playing;
  resting_ = false;
  return true;
}

void RunState::diverge() {
  if (diverged()) return;
  wake();
  before_blow_up_ = state_;
  state_ = State::diverged;
}

bool RunState::go_on() {
  if (!diverged()) return false;
  state_ = before_blow_up_;
  return true;
}

void RunState::begin_again() {
  wake();
  if (diverged()) state_ = before_blow_up_ == State::held ? State::held : State::paused;
}

}  // namespace clothlab::session
