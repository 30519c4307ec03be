// Saves the state from which a session can be restored: about once a second while it changes, in memory for
// its room, and in a file if the server has a folder for sessions.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "server/session/saved.h"

namespace clothlab::session {

class Exchange;
class Stepper;

/// FOLDER/NAME.session
std::filesystem::path session_file(const std::filesystem::path& folder, const std::string& session);
/// Reads a saved session; null if there is no file. A file that cannot be read is renamed to
/// NAME.session.unreadable, never deleted; the error says so.
Result<std::shared_ptr<const Saved>> load_session(const std::filesystem::path& file);

class Keeper {
 public:
  using Clock = std::chrono::steady_clock;

  /// Without `file` the session is saved in memory only.
  Keeper(Exchange& exchange, std::optional<std::filesystem::path> file)
      : exchange_(exchange), file_(std::move(file)) {}

  /// Saves the session if it has changed and the last save is long enough ago.
  void save_if_due(Stepper& stepper, Clock::time_point now);
  /// Saves the session at its end, if it has changed, however recent the last save is.
  void finish(Stepper& stepper);

  static constexpr std::chrono::milliseconds period{900};  ///< so that at most a second is lost

 private:
  void save(Stepper& stepper);
  void write(const Saved& saved);

  Exchange& exchange_;
  std::optional<std::filesystem::path> file_;
  std::uint64_t saved_version_ = 0;
  Clock::time_point next_{};
  bool failing_ = false;
};

}  // namespace clothlab::session
