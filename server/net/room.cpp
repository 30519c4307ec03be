#include "server/net/room.h"

#include <algorithm>
#include <filesystem>

#include "server/net/client.h"
#include "server/net/greeting.h"
#include "server/net/hub.h"
#include "server/net/status.h"
#include "server/session/keeper.h"

namespace clothlab::net {

bool is_session_name(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), allowed);
}

Room::Room(Hub& hub, std::string name, const std::function<void()>& wake, Lock claim)
    : hub_(hub),
      name_(std::move(name)),
      wake_(wake),
      claim_(std::move(claim)),
      unwatched_since_(session::now_us()) {
  if (hub_.relays()) {
    begin_feed();
    return;
  }
  if (hub_.bus()) publisher_.emplace(*hub_.bus(), name_, hub_.run_name());
  const Options& options = hub_.options();
  std::optional<std::filesystem::path> stem;
  if (!options.state_folder.empty()) stem = options.state_folder / name_;
  meshes_ = std::make_shared<session::MeshShelf>(options.assets, std::move(stem));
  std::error_code unseen;
  untouched_ = options.usual_scene && !publisher_ &&
               (options.state_folder.empty() ||
                !std::filesystem::exists(session::session_file(options.state_folder, name_), unseen));
  begin_session(nullptr);
}

/// The most frames that viewers may have got from a failed session since its room last looked; the session
/// that replaces it numbers its frames from after them.
constexpr std::uint32_t frames_unseen = 64;

void Room::begin_session(std::shared_ptr<const session::Saved> saved) {
  const Options& options = hub_.options();
  session::Beginning beginning{name_,  options.document, std::move(saved), {}, last_frame_ + frames_unseen,
                               meshes_};
  if (!options.state_folder.empty() && !file_taken_)
    beginning.file = session::session_file(options.state_folder, name_);
  give_up_session().reset();
  session_ =
      std::make_unique<session::Session>(std::move(beginning), options.limits.scene, options.gpu, wake_);
}

stream::SharedMessage Room::frame(stream::Form form) const {
  stream::SharedMessage frame = session_ ? session_->exchange().frame(form) : nullptr;
  if (frame && topology_ && frame->header.topology_revision != topology_->header.topology_revision)
    return nullptr;
  return frame;
}

void Room::post(session::Command command) {
  if (session_) session_->exchange().post(std::move(command));
}

bool Room::offer(session::Command command) {
  return session_ && session_->exchange().offer(std::move(command));
}

bool Room::capture(std::uint64_t asker, const session::Export& what) {
  if (!offer({{asker, std::nullopt}, what})) return false;
  ++capturing_;
  untouched_ = false;
  return true;
}

std::unique_ptr<session::Source> Room::give_up_session() {
  hub_.metrics().steps_of_closed_sessions += steps();
  feed_ = nullptr;
  return std::move(session_);
}

void Room::stop() {
  if (session_) session_->exchange().stop();
}

void Room::enter(Client& client) {
  clients_.push_back(&client);
  untouched_ = untouched_ && ++entered_ == 1;
  if (started()) greet(client);
  watchers_changed();
}

/// Somebody has come or gone, here or at a relay.
void Room::watchers_changed() {
  post({{}, session::Watchers{static_cast<int>(clients_.size()) + relayed_viewers()}});
  if (empty()) unwatched_since_ = session::now_us();
  broadcast_viewers();
}

void Room::leave(Client& client) {
  std::erase(clients_, &client);
  hub_.lab().client_left(client.id());
  let_go(client);
  if (session_) session_->exchange().leave(client.id());
  demand_changed(std::nullopt);
  watchers_changed();
}

void Room::let_go(const Client& client) {
  post({{client.id(), std::nullopt}, session::GrabEnd{}});
}

void Room::demand_changed(std::optional<stream::Form> fresh) {
  std::array<bool, stream::form_count> at_once{};
  if (fresh) at_once[fresh->index()] = true;
  demand_changed(at_once);
}

void Room::demand_changed(const std::array<bool, stream::form_count>& fresh) {
  session::Demand demand;
  demand.fresh = fresh;
  if (publisher_) demand.rate = publisher_->audience().rates();
  for (const Client* client : clients_) {
    if (!client->pacing().subscribed()) continue;
    double& rate = demand.rate[client->pacing().form().index()];
    rate = std::max(rate, client->pacing().rate());
  }
  for (std::size_t i = 0; i < demand.rate.size(); ++i) {
    // Nobody has asked for this form for a while: the frame in the mailbox may be old.
    if (demanded_[i] <= 0 && demand.rate[i] > 0 && session_)
      session_->exchange().forget_frame(stream::Form::at(i));
    demanded_[i] = demand.rate[i];
  }
  post({{}, demand});
}

void Room::pump() {
  if (!session_) return;
  const std::int64_t now = session::now_us();
  if (feed_) feed_->pump(now);
  handle_events();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const stream::Form form = stream::Form::at(i);
    const stream::SharedMessage latest = demanded_[i] > 0 ? frame(form) : nullptr;
    if (!latest || latest->header.sequence == seen_[i]) continue;
    seen_[i] = last_frame_ = latest->header.sequence;
    for (Client* client : clients_) client->frame_arrived(form, now);
  }
  if (publisher_) pass_frames_on(now);
}

void Room::greet(Client& client) {
  client.greet(notification_text("hello", hello_params(hub_, *this, client)));
  client.send_scene(scene_message());
  if (history_.is_object()) client.send(notification_text("scene.history", history_));
  for (const std::string& notice : standing_notices_) client.send(notice);
}

void Room::broadcast(const char* method, const json& params) {
  if (!empty()) broadcast(make_text(notification_text(method, params)));
}

void Room::broadcast(const SharedText& text) {
  for (Client* client : clients_) client->send(text);
  if (publisher_) publisher_->text(text);
}

/// Tells how many watch. Viewers of a relay are told by the server, which knows of all relays.
void Room::broadcast_viewers() {
  if (!feed_)
    broadcast("viewers", {{"count", clients_.size() + static_cast<std::size_t>(relayed_viewers())}});
}

json Room::status_params(const session::Status& status) const {
  json params = status_of_session(status);
  params.update({{"passes", passes_},
                 {"terms", terms_},
                 {"skipped", skipped_},
                 {"pass_seconds", pass_seconds_},
                 {"solver", solver_},
                 {"renumbered", renumbered_},
                 {"asleep", asleep_},
                 {"recording", session::facts_of(recording())}});
  return params;
}

}  // namespace clothlab::net
