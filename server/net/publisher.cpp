#include "server/net/publisher.h"

#include <algorithm>
#include <utility>

#include "server/session/exchange.h"

namespace clothlab::net {

Publisher::Publisher(bus::Bus& bus, std::string session, std::string origin)
    : bus_(bus), session_(std::move(session)), origin_(std::move(origin)), guard_(session::now_us()) {
  bus_.subscribe(relay::subject(session_, relay::want_word), bus::Keep::all);
  bus_.subscribe(relay::subject(session_, relay::collider_word), bus::Keep::all);
}

Publisher::~Publisher() {
  bus_.unsubscribe(relay::subject(session_, relay::want_word));
  bus_.unsubscribe(relay::subject(session_, relay::collider_word));
}

const bus::Bytes& Publisher::whole(const State& state) {
  if (whole_.data) return whole_;
  return whole_ = bus::bytes_of(relay::text_of(json{{"origin", origin_},
                                                    {"renderer", state.renderer},
                                                    {"document", state.document},
                                                    {"revision", state.revision},
                                                    {"history", state.history}}));
}

void Publisher::answer(const relay::Want& want, const std::string& reply, const State& state) {
  if (reply.empty() || !state.topology) return;
  const std::int64_t now = session::now_us();
  const bool other = want.known.origin != origin_;
  if (other || want.known.topology != state.topology->header.topology_revision) {
    if (!guard_.take_bytes(state.topology->size(), now)) return;  // it will ask again
    send(reply, state.topology, {}, bus::Keep::all);
  }
  const bool news = other || want.known.revision != state.revision;
  if (news && !guard_.take_bytes(whole(state).size, now)) return;
  bus_.send({reply, news ? whole(state) : bus::bytes_of(relay::text_of(json{{"origin", origin_}}))},
            bus::Keep::all);
}

void Publisher::heard(const relay::Want& want, std::int64_t now) {
  const std::array<bool, relay::form_count> fresh = audience_.heard(want, now);
  for (std::size_t i = 0; i < fresh.size(); ++i) fresh_[i] |= fresh[i];
}

Publisher::AudienceChange Publisher::audience_change(std::int64_t now) {
  if (now < tell_at_) return {};
  AudienceChange change;
  change.fresh = std::exchange(fresh_, {});
  change.forms = std::find(change.fresh.begin(), change.fresh.end(), true) != change.fresh.end() ||
                 rates_told_ != audience_.rates();
  change.viewers = viewers_told_ != audience_.viewers();
  rates_told_ = audience_.rates();
  viewers_told_ = audience_.viewers();
  constexpr std::int64_t pause_us = 100'000;
  if (change.forms || change.viewers) tell_at_ = now + pause_us;
  return change;
}

void Publisher::answer_collider(const std::string& name, const std::string& reply, std::string mesh) {
  if (!reply.empty() && guard_.take_bytes(mesh.size(), session::now_us()))
    bus_.send({reply, bus::bytes_of(std::move(mesh)), "collider " + relay::text_of(json(name))},
              bus::Keep::all);
}

void Publisher::text(const SharedText& text) {
  if (audience_.empty()) return;
  bus_.send({relay::subject(session_, relay::text_word), {text, text->data(), text->size()}}, bus::Keep::all);
}

void Publisher::topology(const stream::SharedMessage& topology) {
  if (!audience_.empty()) send(relay::subject(session_, relay::topology_word), topology, {}, bus::Keep::all);
}

void Publisher::frame(const stream::SharedMessage& frame) {
  std::string colliders;
  if (!frame->colliders.empty())
    colliders.assign(frame->colliders.begin() + stream::front_room, frame->colliders.end());
  send(relay::frame_subject(session_, frame->header.form()), frame, std::move(colliders), bus::Keep::newest);
}

void Publisher::send(std::string subject, const stream::SharedMessage& message, std::string note,
                     bus::Keep keep) {
  bus_.send({std::move(subject), {message, message->data(), message->size()}, std::move(note)}, keep);
}

}  // namespace clothlab::net
