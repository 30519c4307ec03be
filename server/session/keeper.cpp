#include "server/session/keeper.h"

#include <algorithm>

#include "server/base/files.h"
#include "server/base/log.h"
#include "server/base/thread_clock.h"
#include "server/session/exchange.h"
#include "server/session/mesh_shelf.h"
#include "server/session/stepper.h"

namespace clothlab::session {

namespace fs = std::filesystem;

fs::path session_file(const fs::path& folder, const std::string& session) {
  return folder / (session + ".session");
}

std::variant<std::shared_ptr<const Saved>, InTheWay> load_session(const fs::path& file) {
  if (!is_taken(file)) return std::shared_ptr<const Saved>();
  std::error_code failure;
  if (!fs::is_regular_file(file, failure))
    return InTheWay{{file.string(), "it is no file", "move it away, and start the server again"}};
  const Result<std::string> bytes = read_file(file);
  Result<Saved> saved = bytes ? saved_from(*bytes) : bytes.error();
  if (saved) return std::make_shared<const Saved>(std::move(*saved));
  return move_aside(file, saved.error().what);
}

InTheWay set_aside(const fs::path& file, const Error& why) {
  fs::path stem = file, folder = file;
  stem.replace_extension();
  folder = free_path(folder.replace_extension(".not-restored"));
  std::error_code failure;
  fs::create_directory(folder, failure);
  if (!failure) fs::rename(file, folder / file.filename(), failure);
  if (failure) {
    std::error_code ignored;
    fs::remove(folder, ignored);
    return {{why.where, why.what, why.remedy + "; " + not_moved(folder, failure)}};
  }
  // The new session may remove or replace its own links.
  for (const fs::path& mesh : mesh_files(stem)) {
    fs::create_hard_link(mesh, folder / mesh.filename(), failure);
    if (failure) fs::copy_file(mesh, folder / mesh.filename(), failure);
    if (failure)
      log(LogLevel::error, "mesh_not_set_aside", {{"file", mesh.string()}, {"why", failure.message()}});
  }
  return {{why.where, why.what,
           why.remedy + "; it is kept in " + folder.filename().string() + " of --state-dir" +
               ": to have it again, end the server, mend that, and move the folder's files back"},
          true};
}

bool Keeper::due(const Stepper& stepper) const {
  return failing_ || stepper.version() != saved_version_;
}

void Keeper::save_if_due(Stepper& stepper, Clock::time_point now) {
  if (now < next_ || !due(stepper)) return;
  const ThreadClock::time_point begun = ThreadClock::now();
  save(stepper);
  next_ = next_save(now, Clock::now(), ThreadClock::now() - begun);
}

Keeper::Clock::time_point Keeper::next_save(Clock::time_point begun, Clock::time_point now,
                                            Clock::duration worked) {
  return std::max(begun + std::max<Clock::duration>(period, 10 * worked), now + (now - begun));
}

void Keeper::finish(Stepper& stepper) {
  if (due(stepper)) save(stepper);
}

void Keeper::save(Stepper& stepper) {
  const auto version = stepper.version();
  auto saved = std::make_shared<const Saved>(stepper.saved());
  if (stepper.lost()) return;  // what has been read may be anything
  saved_version_ = version;
  exchange_.store_saved(saved);
  if (!file_) return;
  const clothlab::Status written = write(*saved);
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

/// First the meshes, which the scene may name. One that the disk has no room for keeps no session from being
/// saved.
clothlab::Status Keeper::write(const Saved& saved) {
  clothlab::Status kept = meshes_ ? meshes_->keep_rest() : ok();
  clothlab::Status written = replace_file(*file_, to_bytes(saved));
  return written ? kept : written;
}

}  // namespace clothlab::session
