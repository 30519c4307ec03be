// A session as the service thread sees it: its clients, its scene and topology as last announced, its frames.
// The session runs in this process, or a bus brings it from another server (Options::relay).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/lock.h"
#include "server/net/json_rpc.h"
#include "server/net/outbox.h"
#include "server/net/publisher.h"
#include "server/relay/feed.h"
#include "server/session/session.h"

namespace clothlab::net {

class Client;
class Hub;

inline constexpr const char* main_session = "main";

/// True for 1 to 64 characters of [A-Za-z0-9_-].
bool is_session_name(const std::string& name);

class Room {
 public:
  /// `claim`: this server's right to open the session, where several share the state folder.
  Room(Hub& hub, std::string name, const std::function<void()>& wake, Lock claim);

  const std::string& name() const { return name_; }
  bool started() const { return !renderer_.empty(); }
  const std::string& renderer() const { return renderer_; }
  const json& document() const { return document_->value; }
  const std::shared_ptr<const scene::Document>& shared_document() const { return document_; }
  std::size_t scene_bytes() const {
    return scene_text_ ? scene_text_->size() : 0;
  }  ///< as scene.get tells it
  /// The document as a file, null: it has not been written since the scene changed.
  const session::JsonText& scene_file() const { return scene_file_; }
  void keep_scene_file(const std::shared_ptr<const scene::Document>& of, session::JsonText file) {
    if (of == document_) scene_file_ = std::move(file);
  }
  const scene::Scene& scene() const { return document_->scene; }
  const stream::SharedMessage& topology() const { return topology_; }
  /// The latest frame; null if there is none yet, or if it does not fit the present topology.
  stream::SharedMessage frame(stream::Form form) const;

  /// What the session has recorded, or is recording.
  session::RecordingFacts recording() const {
    return session_ ? session_->exchange().recording() : session::RecordingFacts{};
  }
  // Only on a relay: the mesh of a collider, null: not known yet; and asking for it, which
  // Hub::deliver_collider answers.
  relay::Feed::ColliderMesh relayed_collider(const std::string& name) const;
  void ask_collider(const std::string& name, std::uint64_t asker);

  void enter(Client& client);
  /// True if nobody has chosen this session's scene, and one client at most has ever come. A picture or a
  /// mesh that was asked for over HTTP counts as somebody.
  bool untouched() const { return untouched_; }
  void leave(Client& client);
  void let_go(const Client& client);  ///< ends the client's hold on the cloth
  /// True if nobody watches, here or through a relay.
  bool empty() const { return clients_.empty() && relayed_viewers() == 0; }
  std::int64_t unwatched_since() const { return unwatched_since_; }  ///< when the last client left [us]
  /// Tells the session which frames its viewers want, after a subscription has changed. `fresh`: a client
  /// needs a frame of this form at once, even if nothing moves.
  void demand_changed(std::optional<stream::Form> fresh);

  /// Passes a command of the server itself to the session.
  void post(session::Command command);
  /// Passes a client's command to the session. False: too many commands of this client wait already.
  [[nodiscard]] bool offer(session::Command command);
  /// Asks the session for its present moment, to make a picture or mesh of it; Hub::captured receives the
  /// moment. False: too many commands of this asker wait already.
  [[nodiscard]] bool capture(std::uint64_t asker, const session::Export& what);
  std::size_t capturing() const { return capturing_; }  ///< moments asked for that have not come yet
  /// Takes the session's events and new frames, and passes them on to clients, hub, lab and bus.
  void pump();
  /// Takes a message of the bus that belongs to this session.
  void receive(const bus::Message& message);
  const std::optional<session::Failed>& failure() const { return failure_; }

  void stop();
  /// Hands the session to the caller, who ends it; its steps stay counted in the metrics.
  std::unique_ptr<session::Source> give_up_session();
  Lock& claim() { return claim_; }
  /// To be released when the session has ended.
  Lock give_up_claim() { return std::move(claim_); }
  bool beats() const { return !session_ || session_->beats(); }
  bool asleep() const { return asleep_; }  ///< as of the last status
  /// Of the session's buffers on its device, as of the last status.
  std::size_t memory_bytes() const { return memory_bytes_; }
  /// Simulated seconds per second over those asked for, as of the last status; none: it does not step.
  std::optional<double> pace() const { return pace_; }
  std::uint64_t steps() const { return session_ ? session_->exchange().steps() : 0; }

 private:
  void handle(session::Started& started);
  void handle(session::Failed& failed);
  void handle(session::Reply& reply);
  void handle(session::SceneChanged& changed);
  void handle(session::HistoryChanged& changed);
  void handle(session::TopologyChanged& changed);
  void handle(session::PartsChanged& changed);
  void handle(session::SolverChanged& changed);
  void handle(session::Diverged& diverged);
  void handle(session::Notice& notice);
  void handle(session::FileTaken&) { file_taken_ = true; }
  void handle(session::Told& told);
  void handle(session::Captured& captured);
  void handle(session::SceneReached& reached);
  void handle(session::SceneLost& lost);
  void handle(session::Held& held);
  void handle(session::ChoiceWanted&);
  void handle(const session::Status& status);
  void handle(const gl::StageTimes& times);
  void handle_events();
  void begin_session(std::shared_ptr<const session::Saved> saved);
  void begin_feed();
  int relayed_viewers() const { return publisher_ ? publisher_->audience().viewers() : 0; }
  void watchers_changed();
  void pass_frames_on(std::int64_t now);
  void hear_want(const bus::Message& message, std::int64_t now);
  bool bring_back(const session::Failed& failed);
  void greet(Client& client);
  void demand_changed(const std::array<bool, stream::form_count>& fresh);
  void broadcast(const char* method, const json& params);
  void broadcast(const SharedText& text);
  void broadcast_viewers();
  const SharedText& scene_message();
  json status_params(const session::Status& status) const;

  Hub& hub_;
  std::string name_;
  std::function<void()> wake_;
  Lock claim_;
  std::shared_ptr<session::MeshShelf> meshes_;  ///< outlives `session_`, which may be replaced
  std::unique_ptr<session::Source> session_;
  relay::Feed* feed_ = nullptr;         ///< `session_` on a relay; null elsewhere
  std::optional<Publisher> publisher_;  ///< with --publish
  std::vector<Client*> clients_;
  bool untouched_ = false;
  int entered_ = 0;  ///< clients that have come, while untouched
  std::vector<session::Event> events_, given_up_events_;
  std::size_t events_handled_ = 0;  ///< of `events_`
  std::string renderer_;
  std::shared_ptr<const scene::Document> document_;
  std::uint64_t revision_ = 0;
  session::JsonText scene_text_;  ///< `document_` and `revision_` as text
  session::JsonText scene_file_;
  SharedText scene_message_;                   ///< the message `scene` of them; null: not needed yet
  json history_;                               ///< as scene.history tells it
  std::vector<std::string> standing_notices_;  ///< for each client that comes
  bool file_taken_ = false;                    ///< see session::FileTaken
  stream::SharedMessage topology_;
  json passes_ = json::array(), terms_ = json::array(), skipped_ = json::array(),
       pass_seconds_ = json::object(), solver_ = json::object(), renumbered_ = json::object();
  std::array<double, stream::form_count> demanded_{};
  std::array<std::uint32_t, stream::form_count>
      seen_{};                           ///< number of the last frame offered to viewers, by form
  std::uint32_t last_frame_ = 0;         ///< number of the newest frame of all forms
  std::vector<std::int64_t> failed_at_;  ///< times at which the session was brought back [us]
  std::optional<session::Failed> failure_;
  std::size_t capturing_ = 0;
  std::int64_t unwatched_since_ = 0;
  bool asleep_ = false;
  std::size_t memory_bytes_ = 0;
  std::optional<double> pace_;
};

}  // namespace clothlab::net
