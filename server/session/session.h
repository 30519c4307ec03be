// A session: one simulation on a thread of its own, with a GL context of its own. This is the service
// thread's handle.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "server/scene/document.h"
#include "server/session/exchange.h"
#include "server/session/limits.h"

namespace clothlab::session {

/// What a session begins with.
struct Beginning {
  std::string name;
  scene::Document document;                   ///< unless it is brought back from:
  std::shared_ptr<const Saved> saved;         ///< what it kept of itself before it failed, else from
  std::optional<std::filesystem::path> file;  ///< where it keeps itself, if anywhere
  std::uint32_t last_frame = 0;               ///< the number of the last frame that viewers have had
};

class Session {
 public:
  /// Starts the thread; what becomes of it arrives as an event (Started or Failed).
  Session(Beginning beginning, const Limits& limits, std::optional<int> gpu, std::function<void()> wake);
  /// Ends the thread and waits for it: a turn at most.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  Exchange& exchange() { return exchange_; }
  const Exchange& exchange() const { return exchange_; }
  /// A thread that has not come round for this long is stuck [s].
  static constexpr double longest_silence = 10;
  bool beats() const {
    return static_cast<double>(now_us() - exchange_.heartbeat_us()) < longest_silence * 1e6;
  }

 private:
  void run(Beginning& beginning, const Limits& limits, std::optional<int> gpu);

  Exchange exchange_;
  std::thread thread_;
};

}  // namespace clothlab::session
