// Saves the state from which a session can be restored: about twice a second while it changes, in memory for
// its room, and in a file if the server has a folder for sessions.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "server/base/files.h"
#include "server/session/saved.h"

namespace clothlab::session {

class Exchange;
class MeshShelf;
class Stepper;

/// FOLDER/NAME.session
std::filesystem::path session_file(const std::filesystem::path& folder, const std::string& session);
/// Reads a saved session; null if nothing is there. A file that cannot be read is moved aside. What is no
/// file, as a folder or a pipe, stays.
std::variant<std::shared_ptr<const Saved>, InTheWay> load_session(const std::filesystem::path& file);
/// Moves the file of a session that could be read, but not brought back because of `why`, into a new folder
/// NAME.not-restored, and links the files of its meshes there: whoever moves the folder's files back has the
/// session again.
InTheWay set_aside(const std::filesystem::path& file, const Error& why);

class Keeper {
 public:
  using Clock = std::chrono::steady_clock;

  /// Without `file` the session is saved in memory only. `meshes` (may be null): those that could not be
  /// saved when they came are tried again with the session.
  Keeper(Exchange& exchange, std::optional<std::filesystem::path> file, std::shared_ptr<MeshShelf> meshes)
      : exchange_(exchange), file_(std::move(file)), meshes_(std::move(meshes)) {}

  /// Saves the session if it has changed, or could not be saved, and the last save is long enough ago.
  void save_if_due(Stepper& stepper, Clock::time_point now);
  /// Saves the session at its end, if it has changed or could not be saved, however recent the last save is.
  void finish(Stepper& stepper);

  /// Half a second, so that a turn and the writing have as long again, where others keep the processors busy,
  /// before more than a second is lost.
  static constexpr std::chrono::milliseconds period{500};
  /// When a state is saved next, after one that was read at `begun` and saved at `now`, which took `worked`
  /// of this thread's processor time. Reading a large state back takes long, so saving takes at most about a
  /// tenth of what the session works; what the thread only waits, for others on the processors, puts nothing
  /// off, unless it waits more than half of the time, as for a slow disk.
  static Clock::time_point next_save(Clock::time_point begun, Clock::time_point now, Clock::duration worked);

 private:
  bool due(const Stepper& stepper) const;
  void save(Stepper& stepper);
  clothlab::Status write(const Saved& saved);

  Exchange& exchange_;
  std::optional<std::filesystem::path> file_;
  std::shared_ptr<MeshShelf> meshes_;
  std::uint64_t saved_version_ = 0;
  Clock::time_point next_{};
  bool failing_ = false;
};

}  // namespace clothlab::session
