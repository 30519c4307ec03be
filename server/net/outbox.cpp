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

bool Outbox::push(SharedText text) {
  bytes_ += text->size();
  texts_.push_back(std::move(text));
  return bytes_ <= max_unsent_text_bytes;
}

void Outbox::push_first(SharedText text) {
  bytes_ += text->size();
  texts_.push_front(std::move(text));
}

bool Outbox::push_status(SharedText text) {
  if (status_) {
    texts_.erase(std::find(texts_.begin(), texts_.end(), status_));
    bytes_ -= status_->size();
  }
  status_ = text;
  return push(std::move(text));
}

SharedText Outbox::pop() {
  if (texts_.empty()) return nullptr;
  SharedText next = std::move(texts_.front());
  texts_.pop_front();
  bytes_ -= next->size();
  if (next == status_) status_.reset();
  return next;
}

}  // namespace clothlab::net
