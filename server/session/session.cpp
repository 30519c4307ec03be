#include "server/session/session.h"

#include <exception>
#include <filesystem>
#include <new>

#include "server/base/files.h"
#include "server/base/log.h"
#include "server/base/pieces.h"
#include "server/gl/context.h"
#include "server/session/fault.h"
#include "server/session/keeper.h"
#include "server/session/stepper.h"
#include "server/sim/memory.h"

namespace clothlab::session {

namespace {

/// For the page: the names of files alone. Where the server's folder is, is for its log.
std::string without_folder(std::string text, const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
  return text;
}

/// Tells of what could not be restored. If it could not be moved either, the session is saved in memory only:
/// its file would take the place of that, and its meshes that of those which belong to it.
void tell_unrestored(Beginning& beginning, Exchange& exchange, const InTheWay& found) {
  std::string why = found.why.text();
  const std::filesystem::path file = beginning.file.value_or("");
  if (!found.moved && beginning.file) {
    beginning.file.reset();
    if (beginning.meshes) beginning.meshes->leave_files();
    exchange.emit(FileTaken{});
    why += "; this session is not saved before the server starts again";
  }
  log(LogLevel::error, "session_not_restored", {{"session", beginning.name}, {"why", why}});
  exchange.emit(Notice{"error", "the saved session cannot be restored: " + without_folder(why, file), true});
}

/// The state that the session's earlier thread saved, else the state in the session's file; null: neither.
std::shared_ptr<const Saved> state_to_restore(Beginning& beginning, Exchange& exchange) {
  if (beginning.saved || !beginning.file) return beginning.saved;
  const auto loaded = load_session(*beginning.file);
  if (const auto* saved = std::get_if<std::shared_ptr<const Saved>>(&loaded)) return *saved;
  tell_unrestored(beginning, exchange, std::get<InTheWay>(loaded));
  return nullptr;
}

Result<std::unique_ptr<Stepper>> bring_back(const Saved& saved, const Beginning& beginning,
                                            const Limits& limits, std::optional<int> gpu,
                                            Exchange& exchange) {
  Result<scene::Document> document = scene::validate(saved.document, beginning.meshes);
  if (!document) return document.error();
  Result<std::unique_ptr<Stepper>> stepper =
      Stepper::create(std::move(*document), exchange, limits, gpu, beginning.last_frame, beginning.meshes);
  if (!stepper) return stepper.error();
  if (clothlab::Status back = (*stepper)->bring_back(saved); !back) return back.error();
  log(LogLevel::info, "session_restored",
      {{"session", beginning.name},
       {"time", std::to_string(saved.time)},
       {"revision", std::to_string(saved.revision)}});
  return stepper;
}

Result<std::unique_ptr<Stepper>> begin(Beginning& beginning, const Limits& limits, std::optional<int> gpu,
                                       Exchange& exchange) {
  if (beginning.meshes && !beginning.saved)  // else they are on the shelf already
    for (const Error& error : beginning.meshes->restore()) {
      log(LogLevel::error, "mesh_not_restored", {{"session", beginning.name}, {"why", error.text()}});
      exchange.emit(Notice{
          "error",
          "an uploaded mesh cannot be restored: " + without_folder(error.text(), beginning.file.value_or("")),
          true});
    }
  if (const std::shared_ptr<const Saved> saved = state_to_restore(beginning, exchange)) {
    Result<std::unique_ptr<Stepper>> stepper = bring_back(*saved, beginning, limits, gpu, exchange);
    if (stepper) return stepper;
    if (sim::is_lack_of_memory(stepper.error())) return stepper;  // it is kept for when there is more
    const bool kept = beginning.file && is_taken(*beginning.file);
    tell_unrestored(beginning, exchange,
                    kept ? set_aside(*beginning.file, stepper.error()) : InTheWay{stepper.error(), true});
  }
  return Stepper::create(std::move(beginning.document), exchange, limits, gpu, beginning.last_frame,
                         beginning.meshes);
}

}  // namespace

Session::Session(Beginning beginning, const Limits& limits, std::optional<int> gpu,
                 std::function<void()> wake)
    : Source(std::move(wake)) {
  exchange_.beat();
  thread_ = std::thread([this, limits, gpu, beginning = std::move(beginning)]() mutable {
    try {
      run(beginning, limits, gpu);
    } catch (const std::bad_alloc&) {
      exchange_.emit(
          Failed{{"session", "there was not enough memory", "a smaller scene, or fewer sessions"}});
    } catch (const GivenUp&) {  // the server stops
    } catch (const std::exception& error) {
      exchange_.emit(
          Failed{{"session", error.what(), "load the scene again; please report it if it happens twice"}});
    }
  });
}

Session::~Session() {
  exchange_.stop();
  thread_.join();
}

void Session::run(Beginning& beginning, const Limits& limits, std::optional<int> gpu) {
  // First a context without a scene, so that a lack of OpenGL is not reported as a fault of the scene.
  if (const Result<std::unique_ptr<gl::Context>> any = gl::Context::create(gpu); !any)
    return exchange_.emit(Failed{any.error(), true});
  Result<std::unique_ptr<Stepper>> stepper = std::unique_ptr<Stepper>();
  const PieceWatch watch([&] {
    exchange_.beat();
    if (*stepper)
      (*stepper)->look_up();
    else if (exchange_.stopping())
      throw GivenUp();
  });
  stepper = begin(beginning, limits, gpu, exchange_);
  if (!stepper) return exchange_.emit(Failed{stepper.error()});
  exchange_.emit(Started{(*stepper)->renderer()});
  Keeper keeper(exchange_, beginning.file, beginning.meshes);
  Clock::time_point next = Clock::now();
  while (exchange_.wait_for_command(next)) {
    next = (*stepper)->turn();
    provoke_fault(beginning.name, exchange_.steps());
    if ((*stepper)->lost() || fault_due(Fault::context_lost, beginning.name, exchange_.steps()))
      return exchange_.emit(Failed{{"OpenGL", "the device was reset, and all that was on it is lost",
                                    "if it happens again, see the driver's log"}});
    keeper.save_if_due(**stepper, Clock::now());
  }
  keeper.finish(**stepper);
}

}  // namespace clothlab::session
