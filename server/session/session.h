// A session: one simulation on a thread of its own, with a GL context of its own. The service thread owns a
// session through this class.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "server/scene/document.h"
#include "server/session/limits.h"
#include "server/session/mesh_shelf.h"
#include "server/session/source.h"

namespace clothlab::session {

/// The input from which a session begins.
struct Beginning {
  std::string name;
  scene::Document document;                   ///< used if the session is not restored from `saved` or `file`
  std::shared_ptr<const Saved> saved;         ///< what a failed thread of this session saved, or null
  std::optional<std::filesystem::path> file;  ///< where the session is saved; none: in memory only
  std::uint32_t last_frame = 0;               ///< the last frame number that viewers may have seen
  std::shared_ptr<MeshShelf> meshes;          ///< that scenes may name; null: none
};

class Session final : public Source {
 public:
  /// Starts the thread. An event tells whether that succeeds (Started or Failed).
  Session(Beginning beginning, const Limits& limits, std::optional<int> gpu, std::function<void()> wake);
  /// Ends the thread and waits for its end, which comes after the present turn.
  ~Session() override;

  /// A thread without a heartbeat for this long is taken for stuck [s].
  static constexpr double longest_silence = 10;
  bool beats() const override {
    return static_cast<double>(now_us() - exchange_.heartbeat_us()) < longest_silence * 1e6;
  }

 private:
  void run(Beginning& beginning, const Limits& limits, std::optional<int> gpu);

  std::thread thread_;
};

}  // namespace clothlab::session
