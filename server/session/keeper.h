// Keeps what a session could be brought back from: once a second while it changes, in memory for its room,
// and in a file where the server has a folder for that.
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

/// NAME.session in the folder.
std::filesystem::path session_file(const std::filesystem::path& folder, const std::string& session);
/// Nothing where there is no file. What cannot be read is moved aside, to NAME.session.unreadable, never
/// deleted; the error says so.
Result<std::shared_ptr<const Saved>> load_session(const std::filesystem::path& file);

class Keeper {
 public:
  using Clock = std::chrono::steady_clock;

  /// `file`: none: in memory only.
  Keeper(Exchange& exchange, std::optional<std::filesystem::path> file)
      : exchange_(exchange), file_(std::move(file)) {}

  /// Keeps the session's present if it has changed and the last time is long enough ago.
  void look(Stepper& stepper, Clock::time_point now);
  /// The last time: whenever the one before was.
  void finish(Stepper& stepper);

  static constexpr std::chrono::milliseconds period{900};  ///< less than the second that may be lost

 private:
  void keep(Stepper& stepper);
  void write(const Saved& saved);

  Exchange& exchange_;
  std::optional<std::filesystem::path> file_;
  std::uint64_t kept_version_ = 0;
  Clock::time_point next_{};
  bool failing_ = false;
};

}  // namespace clothlab::session
