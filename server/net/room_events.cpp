// What a room does with what its session has put out.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/log.h"
#include "server/net/client.h"
#include "server/net/hub.h"
#include "server/net/room.h"

namespace clothlab::net {

/// Time for a room's events at a time [us]: a quarter of that between two frames.
constexpr std::int64_t longest_turn_us = 4000;

/// Handles what the session has put out, for a while: what is left after many answers waits for the next
/// call, so that frames of other sessions go out between.
void Room::handle_events() {
  const std::int64_t begun = session::now_us();
  if (events_handled_ == events_.size()) {
    session_->exchange().take_events(events_);
    events_handled_ = 0;
  }
  while (events_handled_ < events_.size()) {
    std::visit([&](auto& what) { handle(what); }, events_[events_handled_++]);
    if (session::now_us() - begun < longest_turn_us) continue;
    return wake_();
  }
}

void Room::handle(session::Started& started) {
  const bool again = this->started();
  renderer_ = started.renderer;
  log(LogLevel::info, "session_started", {{"session", name_}, {"renderer", renderer_}});
  if (again) return;  // the clients have been greeted
  for (Client* client : clients_) greet(*client);
}

/// Replaces a failed session by one that goes on from its last saved state. False: the failed session had not
/// started or saved anything, or this room has replaced 3 sessions in the last minute.
bool Room::bring_back(const session::Failed& failed) {
  constexpr std::int64_t one_minute = 60'000'000;
  constexpr std::size_t most = 3;
  const std::int64_t now = session::now_us();
  std::erase_if(failed_at_, [&](std::int64_t at) { return now - at > one_minute; });
  const std::shared_ptr<const session::Saved> saved = session_->exchange().saved();
  if (!started() || !saved || failed_at_.size() >= most) return false;
  failed_at_.push_back(now);
  ++hub_.metrics().sessions_brought_back;
  session_->exchange().give_up(failed.error, given_up_events_);
  begin_session(saved);
  for (session::Event& event : given_up_events_) std::visit([&](auto& what) { handle(what); }, event);
  given_up_events_.clear();
  for (Client* client : clients_) client->session_replaced();
  post({{}, session::Watchers{static_cast<int>(clients_.size()) + relayed_viewers()}});
  for (std::size_t i = 0; i < stream::form_count; ++i) demand_changed(stream::Form::at(i));
  hub_.lab().session_replaced(name_);
  broadcast("notice", {{"level", "warning"},
                       {"text", "the session failed and goes on from where it was a second ago: " +
                                    failed.error.text()}});
  return true;
}

void Room::handle(session::SceneLost& lost) {
  hub_.lab().withdraw(lost.job);
}

void Room::handle(session::Failed& failed) {
  pace_.reset();
  if (feed_) {  // viewers have asked for what no server has open
    log(LogLevel::warning, "session_not_there", {{"session", name_}, {"why", failed.error.text()}});
  } else {
    log(LogLevel::error, "session_failed", {{"session", name_}, {"why", failed.error.text()}});
    if (bring_back(failed)) return;
    ++hub_.metrics().sessions_failed;
  }
  broadcast("notice", {{"level", "error"}, {"text", failed.error.text()}});
  while (!clients_.empty()) {
    Client* client = clients_.back();
    client->leave_room();
    client->close(close_internal, "the session has failed");
  }
  failure_ = failed;
}

void Room::handle(session::Reply& reply) {
  Client* client = hub_.find_client(reply.ticket.asker);
  if (!client) return;
  const Client::Served served(*client);
  if (const auto* refusal = std::get_if<session::Refusal>(&reply.answer))
    client->answer(reply.ticket, rpc_error(*refusal));
  else
    client->answer(reply.ticket, std::get<session::JsonText>(reply.answer));
}

void Room::handle(session::SceneChanged& changed) {
  document_ = changed.document;
  revision_ = changed.revision;
  scene_text_ = changed.text;
  scene_file_.reset();
  scene_message_.reset();
  if (publisher_) publisher_->forget_whole();
  hub_.lab().scene_changed(name_, *document_);
  if (changed.told) return;
  if (empty() || (!changed.patch && !started())) return;
  const SharedText text =
      changed.patch
          ? make_text(notification_text(
                "scene.changed", {{"revision", revision_}, {"patch", *changed.patch}, {"by", changed.by}}))
          : scene_message();
  for (Client* client : clients_)
    if (changed.patch)
      client->send_change(text, [this] { return scene_message(); });
    else
      client->send_scene(text);
  if (publisher_) publisher_->text(text);
}

const SharedText& Room::scene_message() {
  if (!scene_message_) scene_message_ = make_text(notification_text("scene", scene_text_));
  return scene_message_;
}

void Room::handle(session::HistoryChanged& changed) {
  history_ = std::move(changed.told);
  if (publisher_) publisher_->forget_whole();
  if (started()) broadcast("scene.history", history_);
}

void Room::handle(session::TopologyChanged& changed) {
  topology_ = changed.message;
  renumbered_ = {{"topology_revision", topology_->header.topology_revision}, {"cloths", changed.renumbered}};
  if (publisher_) publisher_->topology(topology_);
  for (Client* client : clients_) client->wake();
}

void Room::handle(const session::Status& status) {
  asleep_ = status.run.state() == session::RunState::State::asleep;
  memory_bytes_ = status.memory_bytes;
  pace_.reset();
  if (status.paced) pace_ = status.real_time_factor / status.speed;
  handle(status.pass_times);
  if (status.real_time_factor > 0)
    hub_.lab().speed_reported(name_, status.real_time_factor / status.speed, session::now_us());
  if (empty() || !started()) return;
  const SharedText text = make_text(notification_text("sim.status", status_params(status)));
  for (Client* client : clients_) client->send_status(text);
  if (publisher_) publisher_->text(text);
}

void Room::handle(const gl::StageTimes& times) {
  for (const auto& [pass, seconds] : times) {
    hub_.metrics().gpu_passes[pass].add(seconds);
    // The session may have replaced this pass since it was timed.
    if (std::find(passes_.begin(), passes_.end(), pass) != passes_.end()) pass_seconds_[pass] = seconds;
  }
}

void Room::handle(session::PartsChanged& changed) {
  passes_ = terms_ = skipped_ = json::array();
  pass_seconds_ = json::object();
  for (const sim::Simulation::Part& part : changed.parts) {
    if (!part.skipped.empty())
      skipped_.push_back({{"name", part.name}, {"reason", part.skipped}});
    else
      (part.kind == sim::Simulation::Part::Kind::pass ? passes_ : terms_).push_back(part.name);
  }
}

void Room::handle(session::SolverChanged& changed) {
  solver_ = std::move(changed.facts);
}

void Room::handle(session::Diverged& diverged) {
  ++hub_.metrics().divergences;
  const auto finite = [](double value) { return std::isfinite(value) ? json(value) : json(nullptr); };
  const sim::BlowUp::Energy& energy = diverged.energy;
  broadcast("sim.diverged", {{"reason", diverged.reason},
                             {"remedy", {{"text", diverged.remedy}, {"patch", diverged.patch}}},
                             {"energy",
                              {{"allowed", finite(energy.allowed)},
                               {"found", finite(energy.found)},
                               {"time", finite(energy.time)},
                               {"elastic", energy.counts_elastic}}}});
}

void Room::handle(session::Notice& notice) {
  json params{{"level", notice.level}, {"text", notice.text}};
  if (notice.about != nullptr) params["about"] = notice.about;
  if (notice.standing) standing_notices_.push_back(notification_text("notice", params));
  if (!notice.standing || started()) broadcast("notice", params);  // else it comes with the greeting
}

void Room::handle(session::Told& told) {
  const SharedText text = make_text(told.text);
  for (Client* client : clients_)
    if (told.status)
      client->send_status(text);
    else
      client->send(text);
}

void Room::handle(session::Captured& captured) {
  --capturing_;
  hub_.captured(std::move(captured));
}

void Room::handle(session::SceneReached& reached) {
  hub_.lab().scene_taken(reached.job, document_, revision_);
}

void Room::handle(session::Held& held) {
  hub_.lab().held(held.job);
}

void Room::handle(session::ChoiceWanted&) {
  hub_.lab().choose_for(name_, document_);
}

}  // namespace clothlab::net
