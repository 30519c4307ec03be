#include "server/net/outbox.h"

#include <libwebsockets.h>

#include <algorithm>
#include <utility>

#include "server/stream/frame.h"

namespace clothlab::net {

static_assert(stream::front_room >= LWS_PRE, "frames must leave libwebsockets its room");

Text::Text(std::string_view text) {
  bytes_.reserve(LWS_PRE + text.size());
  bytes_.append(LWS_PRE, '\0').append(text);
}

unsigned char* Text::data() const {
  return reinterpret_cast<unsigned char*>(bytes_.data()) + LWS_PRE;
}
std::size_t Text::size() const {
  return bytes_.size() - LWS_PRE;
}

SharedText make_text(std::string_view text) {
  return std::make_shared<const Text>(text);
}

bool Outbox::append(SharedText text, bool own) {
  bytes_ += text->size();
  if (own) own_bytes_ += text->size();
  texts_.push_back({std::move(text), own});
  return bytes_ - (scene_ ? scene_->size() : 0) <= max_unsent_text_bytes;
}

void Outbox::push_first(SharedText text) {
  bytes_ += text->size();
  texts_.push_front({std::move(text)});
}

bool Outbox::push_status(SharedText text) {
  if (status_) drop(status_);
  status_ = text;
  return push(std::move(text));
}

bool Outbox::push_change(SharedText text) {
  changes_.push_back(text);
  return push(std::move(text));
}

void Outbox::push_scene(SharedText text) {
  if (scene_) drop(scene_);
  std::erase_if(texts_, [&](const Waiting& waits) {
    if (changes_.empty() || waits.text != changes_.front()) return false;
    bytes_ -= waits.text->size();
    changes_.pop_front();
    return true;
  });
  scene_ = text;
  (void)push(std::move(text));
}

void Outbox::drop(const SharedText& text) {
  texts_.erase(
      std::find_if(texts_.begin(), texts_.end(), [&](const Waiting& waits) { return waits.text == text; }));
  bytes_ -= text->size();
}

SharedText Outbox::pop() {
  if (texts_.empty()) return nullptr;
  const Waiting next = std::move(texts_.front());
  texts_.pop_front();
  bytes_ -= next.text->size();
  if (next.own) own_bytes_ -= next.text->size();
  if (next.text == status_) status_.reset();
  if (next.text == scene_) scene_.reset();
  if (!changes_.empty() && next.text == changes_.front()) changes_.pop_front();
  return next.text;
}

}  // namespace clothlab::net
