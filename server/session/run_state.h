// The state of a session, such as playing or paused, and the transitions between states. Plain logic, no
// simulation.
#pragma once

namespace clothlab::session {

/// The first state is `playing`, the only one in which a session steps by the clock. A transition that is not
/// allowed changes nothing and returns false. In `held` and `diverged` the state to return to is remembered.
class RunState {
 public:
  enum class State {
    playing,
    asleep,   ///< it plays, but the cloth is at rest: no steps until something happens
    paused,   ///< stopped by a client, which may step it by hand
    held,     ///< stopped by the lab; no client has played, paused or stepped it since
    diverged  ///< it has blown up, and shows the last good state
  };

  State state() const { return state_; }
  bool steps() const { return state_ == State::playing; }
  /// True while it plays or sleeps: clients are told that it plays in both states.
  bool plays() const { return state_ == State::playing || state_ == State::asleep; }
  bool diverged() const { return state_ == State::diverged; }
  /// True if the cloth is at rest: the session is asleep, or the lab holds it and it was asleep before.
  bool at_rest() const { return state_ == State::asleep || (state_ == State::held && resting_); }
  /// True if it plays, or would play after the lab's release and the repair of a blow-up. This is saved with
  /// the session.
  bool would_play() const;

  /// A client plays it. False: it has diverged, and only a change lets it go on.
  [[nodiscard]] bool play();
  /// A client pauses it. A diverged session will be paused after `go_on`.
  void pause();
  /// A client steps it by hand, which pauses it. False: it has diverged.
  [[nodiscard]] bool step_by_hand();
  /// The lab stops it in order to measure. False: it stands still already.
  bool hold();
  /// The lab has measured: it plays or sleeps again. False: it is not held, e.g. because a client has played,
  /// paused or stepped it since.
  bool release();
  /// The cloth has come to rest. False: it does not play.
  bool fall_asleep();
  /// Something has happened to the cloth: it is no longer at rest. False: it was not at rest.
  bool wake();
  /// It has blown up, and stands still from now on.
  void diverge();
  /// The cause of the blow-up was changed: returns to the state before it. False: it has not diverged.
  bool go_on();
  /// The cloth's state was replaced, e.g. by a reset. A diverged session is then paused, or held as before.
  void begin_again();

 private:
  State state_ = State::playing;
  bool resting_ = false;                  ///< in `held`: the session was asleep before
  State before_blow_up_ = State::paused;  ///< in `diverged`: playing, paused or held
};

}  // namespace clothlab::session
