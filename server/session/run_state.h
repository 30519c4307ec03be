// Whether a session runs: one state at a time, and named transitions between them. Plain logic, no
// simulation.
#pragma once

namespace clothlab::session {

/// Begins playing. A session steps by the clock in `playing` alone; what a transition may not do it leaves
/// undone, and says so. What is given up for a while is remembered: `held` and `diverged` know what they go
/// back to.
class RunState {
 public:
  enum class State {
    playing,
    asleep,   ///< it plays, but the cloth is at rest: no steps until something happens
    paused,   ///< by a client, who may step it by hand
    held,     ///< by the lab, and nobody has said anything about that since
    diverged  ///< it has blown up, and shows the last good state
  };

  State state() const { return state_; }
  bool steps() const { return state_ == State::playing; }
  /// To those who look it plays while it sleeps, too.
  bool plays() const { return state_ == State::playing || state_ == State::asleep; }
  bool diverged() const { return state_ == State::diverged; }
  /// The cloth is at rest: in its sleep, and where it was held in its sleep.
  bool at_rest() const { return state_ == State::asleep || (state_ == State::held && resting_); }
  /// Whether it plays once the lab lets it go and what made it diverge is changed: what is kept of it.
  bool would_play() const;

  /// A client wants it to play. False: it has diverged, and only a change lets it go on.
  [[nodiscard]] bool play();
  /// A client wants it to stand still; one that has diverged stands still when it goes on, too.
  void pause();
  /// A client steps it by hand, which pauses it. False: it has diverged.
  [[nodiscard]] bool step_by_hand();
  /// The lab wants it to stand still. False: it stands still already.
  bool hold();
  /// The lab is done. False: it was not held, or somebody has said something since.
  bool release();
  /// The cloth has come to rest. False: it does not play.
  bool fall_asleep();
  /// Something has happened to the cloth. False: it was not at rest.
  bool wake();
  /// It has blown up, and stands still from now on.
  void diverge();
  /// What made it diverge was changed: as it went before. False: it has not diverged.
  bool go_on();
  /// The state was replaced by that of a beginning. One that had diverged stands still there.
  void begin_again();

 private:
  State state_ = State::playing;
  bool resting_ = false;                  ///< of one that is held
  State before_blow_up_ = State::paused;  ///< playing, paused or held
};

}  // namespace clothlab::session
