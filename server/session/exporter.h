// The one thread that makes the pictures and meshes of the HTTP API, one at a time, of moments that sessions
// hand over: no session's steps wait for them. This is the service thread's handle.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/session/exchange.h"

namespace clothlab::session {

/// What an HTTP request gets.
struct Exported {
  std::uint64_t asker = 0;
  const char* content_type = "";
  Result<std::string> body;
};

class Exporter {
 public:
  /// Makes a file's bytes, on the exporter's thread; `make_export` in the server.
  using Make = std::function<Result<std::string>(const Moment&, const Export&)>;

  /// `wake` is called on the exporter's thread after something was made; it must not block.
  Exporter(Make make, std::function<void()> wake) : make_(std::move(make)), wake_(std::move(wake)) {}
  ~Exporter() { stop(); }
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;

  /// Nothing is being made, and what was made has been taken.
  bool idle() const { return !busy_; }
  /// The exporter must be idle. The first one starts the thread.
  void begin(std::uint64_t asker, const Export& what, Moment moment);
  /// What has been made since the last look.
  std::optional<Exported> take();
  /// Waits for what is being made; nothing may begin after it.
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
  bool busy_ = false;  // the service thread's own

  std::mutex mutex_;  // held to move a task, never while anything is made
  std::condition_variable task_arrived_;
  std::optional<Task> task_;
  std::optional<Exported> made_;
  bool ending_ = false;
  std::thread thread_;
};

/// A PNG or OBJ file of `moment`. Makes a GL context current on the calling thread for as long as it needs
/// it, with helper threads of that thread's priority. Error: what failed, no usable OpenGL among it.
Result<std::string> make_export(std::optional<int> gpu, const Moment& moment, const Export& what);

}  // namespace clothlab::session
