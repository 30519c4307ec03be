// What a room does on a bus: a session that runs here is published for relays, one that runs elsewhere is fed
// from there.
#include "server/model/mesh_file.h"
#include "server/net/hub.h"
#include "server/net/room.h"

namespace clothlab::net {

void Room::begin_feed() {
  auto feed = std::make_unique<relay::Feed>(
      *hub_.bus(), name_, hub_.run_name(),
      [this](std::uint64_t asker, const relay::Feed::ColliderMesh& mesh) {
        hub_.deliver_collider(asker, mesh);
      },
      wake_, hub_.limits().scene.memory);
  feed_ = feed.get();
  session_ = std::move(feed);
}

/// Sends relays the frames that are due, and forgets relays that have gone.
void Room::pass_frames_on(std::int64_t now) {
  relay::Audience& audience = publisher_->audience();
  audience.forget_silent(now);
  const Publisher::AudienceChange change = publisher_->audience_change(now);
  if (change.forms) demand_changed(change.fresh);
  if (change.viewers) watchers_changed();
  for (std::size_t i = 0; i < stream::form_count && !audience.empty(); ++i) {
    const stream::Form form = stream::Form::at(i);
    const stream::SharedMessage latest = demanded_[i] > 0 ? frame(form) : nullptr;
    if (latest && audience.due(form, latest->header.sequence, now)) publisher_->frame(latest);
  }
}

void Room::receive(const bus::Message& message) {
  const std::int64_t now = session::now_us();
  if (feed_) return feed_->receive(message, now);
  if (!publisher_ || !started() || !publisher_->may_ask(message.reply, now)) return;
  if (message.subject == relay::subject(name_, relay::want_word)) return hear_want(message, now);
  if (message.subject != relay::subject(name_, relay::collider_word)) return;
  const std::string name(message.bytes.begin(), message.bytes.end());
  publisher_->answer_collider(name, message.reply, model::collider_ply(scene(), name).value_or(""));
}

void Room::hear_want(const bus::Message& message, std::int64_t now) {
  const std::optional<relay::Want> want =
      relay::read_want({reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()});
  if (!want) return;
  publisher_->answer(*want, message.reply, {renderer_, document(), revision_, history_, topology_});
  publisher_->heard(*want, now);
}

relay::Feed::ColliderMesh Room::relayed_collider(const std::string& name) const {
  return feed_ ? feed_->collider(name) : nullptr;
}

void Room::ask_collider(const std::string& name, std::uint64_t asker) {
  if (feed_) feed_->ask_collider(name, asker);
}

}  // namespace clothlab::net
