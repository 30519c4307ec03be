// A connection to a message bus, by which one process sends messages to many. No call waits for the bus:
// while it is away messages are dropped, and the connection is made again by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::bus {

/// Bytes that several owners share.
struct Bytes {
  std::shared_ptr<const void> owner;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
Bytes bytes_of(std::string text);

struct Outgoing {
  std::string subject;
  Bytes bytes;
  std::string note{};   ///< a line of text that belongs to the bytes; empty: none
  std::string reply{};  ///< the subject for an answer; empty: none is asked for
};

struct Message {
  std::string subject;
  std::string reply;
  std::string note;
  std::vector<std::uint8_t> bytes;
  bool unheard = false;  ///< the bus itself says that nobody listens to what this would answer
};

/// What happens to a message that waits when a newer one of the same subject comes.
enum class Keep { all, newest };

struct Counts {
  bool connected = false;
  std::uint64_t sent = 0, sent_bytes = 0;  ///< messages, and bytes of their content
  std::uint64_t dropped = 0;               ///< messages not sent, as the bus was away or too slow
};

class Bus {
 public:
  virtual ~Bus() = default;
  virtual void send(Outgoing message, Keep keep) = 0;
  virtual void subscribe(const std::string& subject, Keep keep) = 0;
  virtual void unsubscribe(const std::string& subject) = 0;
  /// The messages that have come since the last call; `out` is emptied first.
  virtual void take(std::vector<Message>& out) = 0;
  virtual Counts counts() const = 0;
  /// Ends the connection: `wake` is not called any more, and messages are dropped.
  virtual void close() = 0;
};

/// Bytes that may have come and not been taken yet; beyond them messages are dropped.
inline constexpr std::size_t usual_most_come = std::size_t{256} << 20;

/// Connects to the bus at `url` (nats://HOST:PORT, tls:// for TLS), now or as soon as it answers. `name` is
/// what the bus calls this process. `wake` is called on another thread after messages have come, and four
/// times a second. Error: the URL is none, or this program was built without the bus's library.
Result<std::unique_ptr<Bus>> connect(const std::string& url, const std::string& name,
                                     std::function<void()> wake, std::size_t most_come = usual_most_come);

/// The library and its version, for `clothlab info`; empty: there is none in this program.
std::string library();

}  // namespace clothlab::bus
