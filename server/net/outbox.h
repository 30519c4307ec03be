// Text on its way to a client: control messages in order and never dropped; of the status only the newest.
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
  void set_status(SharedText text) { status_ = std::move(text); }
  bool empty() const { return texts_.empty() && !status_; }
  SharedText pop();  ///< null if empty

 private:
  std::deque<SharedText> texts_;
  SharedText status_;
  std::size_t bytes_ = 0;
};

}  // namespace clothlab::net
