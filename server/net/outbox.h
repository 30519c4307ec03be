// The text messages that wait to be sent to a client, in order. Only a status is ever dropped, when a newer
// status replaces it.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

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
  [[nodiscard]] bool push(SharedText text);
  void push_first(SharedText text);
  /// Appends a status and drops the status that still waits, if any. Returns the same as `push`.
  [[nodiscard]] bool push_status(SharedText text);
  bool empty() const { return texts_.empty(); }
  /// True while so much waits that the client should read before it is answered more.
  bool crowded() const { return bytes_ > max_answers_ahead_bytes; }
  SharedText pop();  ///< removes the first message; null if empty

 private:
  std::deque<SharedText> texts_;
  SharedText status_;  ///< the status in `texts_`; null: none
  std::size_t bytes_ = 0;
};

}  // namespace clothlab::net
