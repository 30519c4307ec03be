// Plain HTTP: the page, /healthz, /metrics and the API. Each request has one object, on the service thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/memory_budget.h"
#include "server/net/timer.h"
#include "server/net/web_files.h"
#include "server/session/exporter.h"

struct lws;

namespace clothlab::net {

class Hub;
class Room;

struct HttpAnswer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
  std::shared_ptr<const std::string> shared{};  ///< in the place of `body`: all who get it share one copy
};

class HttpRequest {
 public:
  enum class Progress {
    waits,     ///< a session was asked, and `deliver` answers; or the rest of an answer waits for the socket
    answered,  ///< the answer is written
    close,     ///< the connection must be closed, after a refusal or a failed write
  };

  /// Ends a request that waited, and destroys it.
  using Finish = void (*)(lws* wsi, Progress progress);

  HttpRequest(Hub& hub, const WebFiles& files, lws* wsi, Finish finish);
  ~HttpRequest();
  HttpRequest(const HttpRequest&) = delete;
  HttpRequest& operator=(const HttpRequest&) = delete;

  /// Answers the request, or asks a session for the answer. libwebsockets 4.3 takes what the client sends
  /// next for the next request even while this one waits for its answer. So an answer that is known is
  /// written at once, and while a session is asked nothing more is read.
  /// While others of the client's address have taken the time of the service thread that is the address's,
  /// the answer waits.
  Progress begin(const std::string& path);
  /// Writes the next piece of an answer, once the socket takes more.
  Progress go_on();
  /// Has libwebsockets say when it does.
  void ask_socket() const;
  /// True while an answer is written in pieces.
  bool sending() const { return rest_ != nullptr; }
  /// Answers with the picture or mesh that this request asked for, or with the error. The request is
  /// destroyed.
  void deliver(session::Exported exported);
  /// Answers with a file made of a recording: its page or its film.
  void deliver_made(std::shared_ptr<const std::string> file);
  /// What was reserved for what is made for it.
  MemoryBudget::Reservation take_memory() { return std::move(memory_); }
  /// Answers with the mesh of a collider; null: there is none.
  void deliver_collider(const std::shared_ptr<const std::string>& mesh);
  /// Answers with a session's document as a file.
  void deliver_scene(const session::JsonText& file);
  /// True if the client has closed the connection, so that nobody waits for the answer.
  bool hung_up() const;

 private:
  /// The answer for this path; empty: a session was asked for it.
  std::optional<HttpAnswer> find(const std::string& path);
  Progress answer();
  HttpAnswer handshake_answer() const;
  HttpAnswer file(const std::string& path) const;
  /// The document of the room's scene, which the workbench writes.
  std::optional<HttpAnswer> scene_file(Room& room);
  /// The same for the paths that need a token, if the server has one: /metrics and the API.
  std::optional<HttpAnswer> find_protected(const std::string& path);
  /// Asks the session for a picture or mesh. Returns the refusal if too many wait already.
  std::optional<HttpAnswer> ask_session(const std::string& session, session::Export what);
  /// The mesh of a collider, of which a relay asks the server.
  std::optional<HttpAnswer> collider_mesh(Room& room, const std::string& name);
  /// The room's recording, alone or (after a while) in its page or as a film; a refusal if there is none.
  std::optional<HttpAnswer> recording(const Room& room, const std::string& ending);
  HttpAnswer made_of_recording(std::shared_ptr<const std::string> file) const;
  Progress send(HttpAnswer answer);
  /// Reserves memory. Returns the refusal if there is not so much.
  std::optional<HttpAnswer> reserve(MemoryBudget::Use use, std::uint64_t bytes);
  void keep_unsent_few() const;
  void await_socket() const;
  /// Answers a request that may have a body, which is not read: the connection must be closed.
  Progress refuse(const HttpAnswer& refusal);
  /// The answer that refuses a client without a valid token; empty: the client may go on.
  std::optional<HttpAnswer> refusal() const;

  Hub& hub_;
  const WebFiles& files_;
  lws* wsi_;
  Finish finish_;
  std::uint64_t id_;
  std::string network_;  ///< of the client, as limits count it
  std::string path_{};
  Timer later_;
  std::string ending_{};     ///< of a file of a recording
  std::string file_name_{};  ///< under which a browser keeps the answer; empty: it shows it
  std::string reader_;       ///< the allowed origin of another page that asks, and may read the answer
  std::shared_ptr<const std::string> rest_{};  ///< the body that is being written in pieces
  MemoryBudget::Reservation memory_{};  ///< of what is made for it, then of `rest_`, unless it is shared
  std::size_t sent_ = 0;                ///< of it
  bool head_ = false;                   ///< the request is HEAD: its answer has no body
  bool last_ = false;                   ///< the answer says that the connection will be closed
};

}  // namespace clothlab::net
