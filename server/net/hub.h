// The state of the service thread: rooms (a session and its clients), all clients, the HTTP requests in
// progress, and the message bus. Only the service thread touches it.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/log.h"
#include "server/base/log_bound.h"
#include "server/bus/bus.h"
#include "server/lab/cache.h"
#include "server/net/connections.h"
#include "server/net/held_messages.h"
#include "server/net/lab_queue.h"
#include "server/net/metrics.h"
#include "server/net/options.h"
#include "server/net/room.h"
#include "server/net/service_time.h"
#include "server/net/token_guard.h"
#include "server/net/workbench.h"
#include "server/session/exporter.h"

namespace clothlab::net {

class Client;
class HttpRequest;

enum class Role { none, viewer, operator_ };
const char* name(Role role);

/// The result of checking a token.
struct TokenCheck {
  Role role = Role::none;
  int wait = 0;  ///< above 0: the token was not checked, as no token from its address is for so long [s]
};

class Hub {
 public:
  /// `wake` makes the service thread call `pump`; any thread may call it.
  Hub(Options options, std::function<void()> wake);
  /// Connects to the bus of the options, if there is one. To be called before any room is opened.
  Status join_bus();
  ~Hub();

  const Options& options() const { return options_; }
  const Limits& limits() const { return options_.limits; }
  Metrics& metrics() { return metrics_; }
  LabQueue& lab() { return *lab_; }
  Connections& connections() { return connections_; }
  Workbench& workbench() { return workbench_; }
  LogBound& refusals() { return refusals_; }  ///< lines of the log about clients that are not let in
  /// The service thread's time that all clients share, and that requests over plain HTTP do.
  ServicePool& service() { return service_; }
  ServicePool& http_service() { return http_service_; }

  /// The role that a token gives its client; where no token is needed every client is an operator, of a relay
  /// a viewer.
  Role role_of(const std::string& token) const;
  /// The role of a token that came from `address`, or how long that address must wait after too many wrong
  /// tokens. A wrong token is counted, and logged with the fields `who`.
  TokenCheck check_token(const std::string& token, const std::string& address, std::vector<LogField> who);
  bool needs_token() const { return !options_.token.empty() || !options_.view_token.empty(); }
  /// Why a request with this Host header is refused; empty: it is not. With `--token` any name is allowed.
  std::string host_refusal(const std::string& host) const;

  /// The message bus, null without one; `run_name` is what this run of the program calls itself there.
  bus::Bus* bus() { return bus_.get(); }
  const std::string& run_name() const { return run_name_; }
  /// True for `clothlab relay`: sessions run elsewhere, and viewers only watch.
  bool relays() const { return options_.relay; }
  /// True if sessions are opened when somebody asks for them and given up when nobody watches, `main` too.
  bool opens_on_demand() const { return options_.share_state || relays(); }

  Room* find_room(const std::string& name);
  /// The room of this name, opened if it is new; null beyond --max-sessions, and if another server has the
  /// session open. To make place, the room that has been without viewers for the longest time, at least
  /// --unwatched-timeout, is closed; `main` only where sessions are opened on demand.
  Room* open_room(const std::string& name);
  bool has_place_for(const std::string& name);
  /// True if another server that shares the state folder has the session open.
  bool elsewhere(const std::string& name);
  /// True if the session is open or kept in the state folder. A viewer may enter no other session, because
  /// that would create it.
  bool knows_session(const std::string& name);

  /// Where sessions are opened on demand: gives up those that nobody has watched for --unwatched-timeout, so
  /// that another server can open them.
  void give_up_sleeping_rooms();

  void add(Client& client);
  void remove(Client& client);
  Client* find_client(std::uint64_t id);
  bool full() const { return clients_.size() >= static_cast<std::size_t>(options_.limits.clients); }
  /// True if this address has as many clients as one address may have.
  bool full(const std::string& address) const;
  /// Why a client of this address cannot enter the session now, in words for it; empty: it can. That passes:
  /// the client may try again.
  std::string no_place(const std::string& session, const std::string& address);
  bool empty() const { return clients_.empty(); }
  void close_all(int code, const std::string& reason);
  std::uint64_t next_id() { return ++last_id_; }
  /// The large messages that clients are being sent.
  HeldMessages& held_messages() { return held_messages_; }
  /// To make room in memory: closes the client whose socket has taken nothing for the longest time, of those
  /// for whom much is kept; `otherwise`, if there is none.
  void close_slowest_reader(Client& otherwise);

  void add(std::uint64_t id, HttpRequest& request) { waiting_[id] = &request; }
  void remove_request(std::uint64_t id) { waiting_.erase(id); }
  HttpRequest* find_request(std::uint64_t id);
  /// The number of pictures and meshes that wait or are being made, including those whose session has not
  /// handed over its moment yet.
  std::size_t exports_waiting() const;
  bool exports_full() const { return exports_waiting() >= max_exports; }
  /// Takes the moment that a session has handed over for a picture or mesh, or the reason why it did not.
  void captured(session::Captured captured);

  /// Passes on the mesh of a collider that the HTTP request `asker` asked for; null: there is none.
  void deliver_collider(std::uint64_t asker, const relay::Feed::ColliderMesh& mesh);

  /// Has the page or the film of a recording, as `ending` says, made for the HTTP request `asker`.
  void make_of_recording(std::uint64_t asker, const session::RecordingFacts& recording,
                         const std::string& ending);
  /// The same while it is being sent to somebody, so that all get the same copy; else null.
  std::shared_ptr<const std::string> made_of(const std::shared_ptr<const std::string>& recording,
                                             const std::string& ending) const;

  /// Passes on what the sessions, the exporter, the lab and the bus have put out.
  void pump();
  /// Stops every session's thread and the lab's, and waits for them.
  void stop_sessions();
  /// Why the session `main` failed; empty: it has not.
  const std::optional<session::Failed>& main_failure() const { return main_failure_; }

  Gauges gauges() const;
  bool all_sessions_beat() const;

 private:
  LabQueue::Port lab_port();
  void pump_bus();
  void deliver(session::Exported exported);
  void deliver_made(std::uint64_t asker, std::shared_ptr<const std::string> file);
  void pump_exports();
  std::uint64_t steps() const;
  void retire(const std::string& name);
  /// Tells the servers that share the folder for what reason no client more can enter this session.
  void note_full(const std::string& session, const std::string& line);
  void forget_full();  ///< a client has left, so that there is room
  std::string sleeping_room() const;
  std::string renderer() const;
  std::filesystem::path lock_file(const std::string& session) const;

  Options options_;
  std::function<void()> wake_;
  Metrics metrics_;
  Connections connections_{options_.limits, options_.trusted_proxies};
  ServicePool service_{service_of_address, service_of_all},
      http_service_{http_service_of_address, http_service_of_all};
  HeldMessages held_messages_{options_.limits.scene.memory};
  Workbench workbench_{wake_};
  LogBound refusals_{LogLevel::warning, "client_refused"};
  TokenGuard token_guard_{options_.limits.wrong_tokens};
  lab::Cache lab_cache_;
  std::unique_ptr<LabQueue> lab_;
  session::Exporter exporter_;
  std::string run_name_;
  MemoryBudget::Reservation bus_memory_{};  ///< of what has come by it to a relay
  std::unique_ptr<bus::Bus> bus_;           ///< before the rooms, which use it
  std::vector<bus::Message> from_bus_;
  std::deque<session::Captured> captured_;  ///< what the exporter makes next, first come first
  struct MadeFile {
    std::weak_ptr<const std::string> recording;
    std::string ending;
    std::weak_ptr<const std::string> file;
  };
  std::vector<MadeFile> made_files_;  ///< of recordings, for as long as they are being sent
  std::map<std::string, std::unique_ptr<Room>> rooms_;
  std::map<std::uint64_t, Client*> clients_;
  std::map<std::string, std::string> full_notes_;  ///< by session, what is written in its lock
  std::map<std::uint64_t, HttpRequest*> waiting_;
  std::vector<std::future<void>> retiring_;
  /// Of clients and requests. Those of relays differ from those of the server whose messages they pass on.
  std::uint64_t last_id_ = options_.relay ? std::uint64_t{1} << 40 : 0;
  std::optional<session::Failed> main_failure_;
};

}  // namespace clothlab::net
