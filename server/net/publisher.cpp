#include "server/net/publisher.h"

#include <utility>

namespace clothlab::net {

Publisher::Publisher(bus::Bus& bus, std::string session, std::string origin)
    : bus_(bus), session_(std::move(session)), origin_(std::move(origin)) {
  bus_.subscribe(relay::subject(session_, relay::want_word), bus::Keep::all);
  bus_.subscribe(relay::subject(session_, relay::collider_word), bus::Keep::all);
}

Publisher::~Publisher() {
  bus_.unsubscribe(relay::subject(session_, relay::want_word));
  bus_.unsubscribe(relay::subject(session_, relay::collider_word));
}

void Publisher::answer(const relay::Want& want, const std::string& reply, const State& state) {
  if (reply.empty() || !state.topology) return;
  const bool other = want.known.origin != origin_;
  if (other || want.known.topology != state.topology->header.topology_revision)
    send(reply, state.topology, {}, bus::Keep::all);
  json answer{{"origin", origin_}};
  if (other || want.known.revision != state.revision)
    answer.update({{"renderer", state.renderer},
                   {"document", state.document},
                   {"revision", state.revision},
                   {"history", state.history}});
  bus_.send({reply, bus::bytes_of(relay::text_of(answer))}, bus::Keep::all);
}

void Publisher::answer_collider(const std::string& name, const std::string& reply, std::string mesh) {
  if (!reply.empty())
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
