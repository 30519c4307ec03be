// The text messages that wait to be sent to a client, in order. Only what a newer message replaces is ever
// dropped: a status by the next one, and what was said of the scene's document by the whole of it.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "server/net/limits.h"

namespace clothlab::net {

/// A text message with LWS_PRE spare bytes in front, as libwebsockets requires; all receivers share it.
class Text {
 public:
  explicit Text(std::string_view text);
  /// The text's first byte. libwebsockets writes its header into the spare bytes, never into the text.
  unsigned char* data() const;
  std::size_t size() const;

 private:
  mutable std::string bytes_;
};
using SharedText = std::shared_ptr<const Text>;
SharedText make_text(std::string_view text);

class Outbox {
 public:
  /// Appends a message. False: more than max_unsent_text_bytes wait, because the client does not read.
  [[nodiscard]] bool push(SharedText text) { return append(std::move(text), false); }
  /// The same of one that only this client gets.
  [[nodiscard]] bool push_own(SharedText text) { return append(std::move(text), true); }
  void push_first(SharedText text);
  /// Appends a change of the scene's document. Returns the same as `push`.
  [[nodiscard]] bool push_change(SharedText text);
  /// Appends the whole document, and drops what waits of earlier ones and their changes. It does not count
  /// among what `push` bounds: only one ever waits.
  void push_scene(SharedText text);
  /// Appends a status and drops the status that still waits, if any. Returns the same as `push`.
  [[nodiscard]] bool push_status(SharedText text);
  bool empty() const { return texts_.empty(); }
  /// True while so much waits that the client should read before it is answered more.
  bool crowded() const { return bytes_ > max_answers_ahead_bytes; }
  std::size_t own_bytes() const { return own_bytes_; }  ///< of those that only this client gets
  SharedText pop();                                     ///< removes the first message; null if empty

 private:
  struct Waiting {
    SharedText text;
    bool own = false;
  };
  bool append(SharedText text, bool own);
  void drop(const SharedText& text);

  std::deque<Waiting> texts_;
  SharedText status_;                      ///< the status in `texts_`; null: none
  SharedText scene_;                       ///< the document in `texts_`; null: none
  std::deque<SharedText> changes_;         ///< of the document, in `texts_` in this order
  std::size_t bytes_ = 0, own_bytes_ = 0;  ///< of `texts_`
};

}  // namespace clothlab::net
