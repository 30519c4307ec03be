// What a client is sent, one message or piece of it at a time, as libwebsockets asks for it.
#include <libwebsockets.h>

#include <algorithm>
#include <utility>

#include "server/net/client.h"

namespace clothlab::net {

/// True if messages may be sent: after `hello`, or to a client without a role or room, which gets no `hello`.
bool Client::may_send() const {
  return greeted_ || role_ == Role::none || !room_;
}

int Client::writeable() {
  took_last_ = session::now_us();
  // A client whose session failed first gets the text that waits for it. In all other cases, a flood among
  // them, the close frame goes out at once.
  const bool finish_first = close_code_ == close_internal && (is_sending() || !outbox_.empty());
  if (close_code_ != 0 && !finish_first) return send_close();
  if (is_sending()) return write_piece();
  if (!may_send()) return 0;
  return send_next();
}

// lws_close_reason would close the socket with the client's messages unread; the kernel would then reset the
// connection, and the client would never learn the reason. So the close frame is written here, and further
// messages are read and dropped until the client answers it, or for 2 s.
int Client::send_close() {
  if (std::exchange(close_sent_, true)) return 0;
  constexpr std::size_t longest = 123;  // bytes of a close frame's reason (RFC 6455, 5.5)
  const std::string reason = close_reason_.substr(0, longest);
  std::string frame{'\x88', static_cast<char>(reason.size() + 2), static_cast<char>(close_code_ >> 8),
                    static_cast<char>(close_code_ & 0xFF)};
  const Text text(frame + reason);
  lws_set_timeout(wsi_, PENDING_TIMEOUT_CLOSE_SEND, 2);
  return lws_write(wsi_, text.data(), text.size(), LWS_WRITE_RAW) < 0 ? -1 : 0;
}

/// Between two texts goes a frame that is due, so that frames do not wait for many answers. One of a new
/// topology waits, because all that was said before it comes first; and the first one of a form, because the
/// answer to its subscription comes first: it tells a viewer what is in the frame.
bool Client::frame_goes_first() {
  if (!std::exchange(text_was_last_, false) || !room_ || !pacing_.subscribed() || !topology_sent_ ||
      !pacing_.sent_any())
    return false;
  const stream::SharedMessage frame = room_->frame(pacing_.form());
  return frame && frame->header.topology_revision == topology_revision_ &&
         pacing_.is_news(frame->header.sequence) &&
         pacing_.wait(session::now_us()) == std::optional<std::int64_t>(0);
}

// Sends one message a call, as libwebsockets requires: text first, then the topology, then the latest frame.
int Client::send_next() {
  if (const SharedText text = frame_goes_first() ? nullptr : outbox_.pop()) {
    const Served served(*this);
    text_was_last_ = true;
    wake();
    if (!outbox_.crowded()) {
      ask_next_at_length();
      read_on();
    }
    account_unread();
    return write(text, text->data(), text->size(), true);
  }
  if (!room_ || !pacing_.subscribed()) return 0;
  const stream::SharedMessage& topology = room_->topology();
  if (topology && (!topology_sent_ || topology_revision_ != topology->header.topology_revision)) {
    topology_sent_ = true;
    topology_revision_ = topology->header.topology_revision;
    wake();
    return write(topology, topology->data(), topology->size(), false);
  }
  const stream::SharedMessage frame = room_->frame(pacing_.form());
  if (!frame || !pacing_.is_news(frame->header.sequence)) return 0;
  const std::optional<std::int64_t> wait = pacing_.wait(session::now_us());
  if (!outbox_.empty()) wake();
  if (wait && *wait == 0) return send_frame(frame);
  if (wait) lws_set_timer_usecs(wsi_, *wait);
  return 0;
}

int Client::send_frame(const stream::SharedMessage& frame) {
  if (!frame->colliders.empty() && colliders_sent_for_ != frame->header.sequence) {
    colliders_sent_for_ = frame->header.sequence;
    wake();  // the next call sends the frame itself
    return write(frame, frame->colliders.data() + stream::front_room,
                 frame->colliders.size() - stream::front_room, true);
  }
  const std::int64_t held_until = pacing_.ready_since(session::now_us());
  const int result = write(frame, frame->data(), frame->size(), false);
  const std::int64_t now = session::now_us();
  pacing_.sent(frame->header.sequence, now);
  frame_waits_ = false;
  ++hub_.metrics().frames_sent;
  hub_.metrics().latency.add(1e-6 * static_cast<double>(now - std::max(frame->made_at_us, held_until)));
  return result;
}

// libwebsockets copies what the socket does not take of a write. So a long message goes in pieces, the frames
// of which RFC 6455 calls fragments: one who reads nothing costs a piece, and what all share.
int Client::write(std::shared_ptr<const void> owner, const unsigned char* data, std::size_t size, bool text) {
  hub_.metrics().bytes_sent += size;
  bytes_sent_ += size;
  // libwebsockets writes its header into the space before the data: the same bytes for every client, so that
  // they can share the message.
  if (size <= most_whole_bytes)
    return lws_write(wsi_, const_cast<unsigned char*>(data), size, text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY) <
                   0
               ? -1
               : 0;
  std::shared_ptr<const void> held;
  while (!(held = hub_.held_messages().hold(owner, size)) && close_code_ == 0)
    hub_.close_slowest_reader(*this);
  if (!held) return 0;  // this client is closed itself
  sending_ = {std::move(held), data, size, 0, text};
  return write_piece();
}

int Client::write_piece() {
  const std::size_t size = std::min(piece_bytes, sending_.size - sending_.sent);
  const bool first = sending_.sent == 0, last = sending_.sent + size == sending_.size;
  const Text piece({reinterpret_cast<const char*>(sending_.data + sending_.sent), size});
  const int protocol = lws_write_ws_flags(sending_.text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY, first, last);
  sending_.sent += size;
  if (last) sending_ = {};
  wake();
  return lws_write(wsi_, piece.data(), size, static_cast<lws_write_protocol>(protocol)) < 0 ? -1 : 0;
}

}  // namespace clothlab::net
