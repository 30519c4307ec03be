#include "server/session/keeper.h"

#include <algorithm>

#include "server/base/files.h"
#include "server/base/log.h"
#include "server/session/exchange.h"
#include "server/session/stepper.h"

namespace clothlab::session {

namespace fs = std::filesystem;

fs::path session_file(const fs::path& folder, const std::string& session) {
  return folder / (session + ".session");
}

Result<std::shared_ptr<const Saved>> load_session(const fs::path& file) {
  std::error_code failure;
  if (!fs::exists(file, failure)) return std::shared_ptr<const Saved>();
  const Result<std::string> bytes = read_file(file);
  Result<Saved> saved = bytes ? saved_from(*bytes) : bytes.error();
  if (saved) return std::make_shared<const Saved>(std::move(*saved));
  fs::path aside = file;
  aside += ".unreadable";
  fs::rename(file, aside, failure);
  if (failure)
    return Error{file.string(), saved.error().what,
                 "it could not be moved to " + aside.string() + " (" + failure.message() +
                     "): move it away if it is to be kept"};
  return Error{file.string(), saved.error().what, "it was moved to " + aside.string()};
}

void Keeper::save_if_due(Stepper& stepper, Clock::time_point now) {
  if (now < next_ || stepper.version() == saved_version_) return;
  const Clock::time_point begun = Clock::now();
  save(stepper);
  // Reading a large state back takes long. Saving takes at most about a tenth of the session's time.
  next_ = now + std::max<Clock::duration>(period, 10 * (Clock::now() - begun));
}

void Keeper::finish(Stepper& stepper) {
  if (stepper.version() != saved_version_) save(stepper);
}

void Keeper::save(Stepper& stepper) {
  saved_version_ = stepper.version();
  auto saved = std::make_shared<const Saved>(stepper.saved());
  exchange_.store_saved(saved);
  if (file_) write(*saved);
}

void Keeper::write(const Saved& saved) {
  const clothlab::Status written = replace_file(*file_, to_bytes(saved));
  if (written) {
    if (std::exchange(failing_, false))
      log(LogLevel::info, "session_saved_again", {{"file", file_->string()}});
    return;
  }
  if (std::exchange(failing_, true)) return;  // already reported
  log(LogLevel::error, "session_not_saved", {{"file", file_->string()}, {"why", written.error().text()}});
  exchange_.emit(Notice{"error", "this session cannot be saved: " + written.error().what +
                                     "; it goes on, but would be lost with the server"});
}

}  // namespace clothlab::session
