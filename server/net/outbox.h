// Text on its way to a client, in order: nothing is dropped but a status that a newer one follows.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

namespace clothlab::net {

/// One text message with the room in front that libwebsockets wants; shared by all clients it goes to.
class Text {
 public:
  explicit Text(std::string_view text);
  /// libwebsockets writes its own header into the room in front of the message; the text stays as it is.
  unsigned char* data() const;
  std::size_t size() const;

 private:
  mutable std::string bytes_;
};
using SharedText = std::shared_ptr<const Text>;
SharedText make_text(std::string_view text);

class Outbox {
 public:
  /// False: the client lets more than max_unsent_text_bytes pile up.
  [[nodiscard]] bool push(SharedText text);
  void push_first(SharedText text);
  /// In place of the status that waits, but behind what was said since.
  [[nodiscard]] bool push_status(SharedText text);
  bool empty() const { return texts_.empty(); }
  SharedText pop();  ///< null if empty

 private:
  std::deque<SharedText> texts_;
  SharedText status_;  ///< the one among them, null: none
  std::size_t bytes_ = 0;
};

}  // namespace clothlab::net
