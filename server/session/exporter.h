// Makes the pictures and meshes of the HTTP API on a thread of its own, one at a time, from moments that
// sessions hand over, so that no session's steps wait for them. The service thread uses this class.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/session/exchange.h"

namespace clothlab::session {

/// The answer to an HTTP request.
struct Exported {
  std::uint64_t asker = 0;
  const char* content_type = "";
  Result<std::string> body;
  std::shared_ptr<const std::string> recording{};  ///< that it is made of; else null
  std::string ending{};                            ///< of a recording's file
};

class Exporter {
 public:
  /// Makes a file's bytes on the exporter's thread. The server uses `make_export`.
  using Make = std::function<Result<std::string>(const Moment&, const Export&)>;

  /// `wake` is called on the exporter's thread after each export; it must not block.
  Exporter(Make make, std::function<void()> wake) : make_(std::move(make)), wake_(std::move(wake)) {}
  ~Exporter() { stop(); }
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;

  /// True if no export is under way and the result of the last one has been taken.
  bool idle() const { return !busy_; }
  /// Starts an export. The exporter must be idle. The first call starts the thread.
  void begin(std::uint64_t asker, const Export& what, Moment moment);
  /// The result of the export under way, once it is ready; none: not ready yet.
  std::optional<Exported> take();
  /// Waits for the export under way and ends the thread. No `begin` is allowed afterwards.
  void stop();

 private:
  struct Task {
    std::uint64_t asker = 0;
    Export what;
    Moment moment;
  };
  void run();
  Result<std::string> carry_out(const Task& task) const;

  const Make make_;
  const std::function<void()> wake_;
  bool busy_ = false;  // used by the service thread only

  std::mutex mutex_;  // held to move a task or a result, never during an export
  std::condition_variable task_arrived_;
  std::optional<Task> task_;
  std::optional<Exported> made_;
  bool ending_ = false;
  std::thread thread_;
};

/// A PNG or OBJ file of `moment`, or the page or the film of the recording in it. For a PNG a GL context is
/// current on the calling thread until the picture is drawn. Error: what failed, e.g. no usable OpenGL.
Result<std::string> make_export(std::optional<int> gpu, const Moment& moment, const Export& what);

}  // namespace clothlab::session
