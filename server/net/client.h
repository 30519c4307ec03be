// One WebSocket connection: handles the client's messages, queues text for the client and sends its frames.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/net/hub.h"
#include "server/net/json_rpc.h"
#include "server/net/outbox.h"
#include "server/net/pacing.h"
#include "server/net/service_time.h"
#include "server/net/timer.h"

struct lws;

namespace clothlab::net {

class Client {
 public:
  /// The client enters the session of this name at once if no token is needed, else after `auth`.
  Client(Hub& hub, lws* wsi, std::string session);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  std::uint64_t id() const { return id_; }
  Role role() const { return role_; }
  const std::string& address() const { return address_; }
  const std::string& session() const { return session_; }
  Hub& hub() { return hub_; }
  Room* room() { return room_; }
  FramePacing& pacing() { return pacing_; }
  const FramePacing& pacing() const { return pacing_; }

  // Called for events of libwebsockets; a return value of -1 closes the connection.
  int receive(const char* data, std::size_t size);
  int writeable();
  void timer();
  /// True once the server has sent its close frame; the client's close frame is then the answer to it.
  bool close_sent() const { return close_sent_; }
  /// Makes libwebsockets call `writeable` soon, because something is ready to be sent.
  void wake();

  /// Gives the client this role and lets it enter its session. False: there are too many sessions.
  bool admit(Role role);
  void subscribe(stream::Form form, double rate, int in_flight);
  void unsubscribe();
  void acknowledge(std::uint32_t sequence);
  void leave_room();
  /// Passes a request to the session whose answer may be long, after the answers to those before it have been
  /// sent: who reads slowly has one of them unread at a time. False: too many wait already.
  [[nodiscard]] bool ask_at_length(session::Command command);
  /// What a mesh.upload keeps until the session has read its mesh; null while an earlier one does.
  std::shared_ptr<void> begin_upload();

  /// While it lives, the service thread works for the client, which pays for that time.
  class Served {
   public:
    explicit Served(Client& client) : client_(client) {}
    ~Served() { client_.pay(since_); }
    Served(const Served&) = delete;
    Served& operator=(const Served&) = delete;

   private:
    Client& client_;
    std::int64_t since_ = thread_time_us();
  };

  // Mostly called by the room.
  void greet(const std::string& hello);  ///< sends `hello` before all text that waits
  void send(const std::string& text);    ///< to this client alone
  void send(SharedText text);
  /// Sends the answer to a request; a notification (a ticket without id) gets none, but for a notice of an
  /// error in one that pulls at the cloth.
  void answer(const session::Ticket& ticket, const std::variant<json, session::JsonText, RpcError>& answer);
  /// Has the answer made on the workbench. Until it is there, nothing more is read from the client.
  void answer_aside(session::Ticket ticket, std::function<session::JsonText()> make);
  void send_status(SharedText text);
  void send_scene(SharedText text);  ///< the whole document
  /// A change of the document; to a client that reads slowly `whole` in its place.
  void send_change(SharedText text, const std::function<SharedText()>& whole);
  /// The session was brought back after it failed: the topology is sent again before the next frame.
  void session_replaced();
  void frame_arrived(stream::Form form, std::int64_t now);

  /// True if much is in memory because this client has not read it.
  bool keeps_much() const {
    return close_code_ == 0 && (is_sending() || outbox_.own_bytes() >= unread_unit_bytes);
  }
  std::int64_t took_last() const { return took_last_; }  ///< when its socket took something last [us]

  /// Closes the connection with a close code of RFC 6455, as soon as the close frame can be sent.
  void close(int code, std::string reason);

 private:
  bool enter_room();
  void close_without_room();
  /// The bytes that the message may have which is being received, of which `data` has just come.
  std::size_t most_bytes(std::string_view data);
  void refuse_too_long(std::size_t most);
  double price_of_message() const;
  void tell_refused_grab(const std::string& method, const RpcError& error);
  void receive_part(const char* data, std::size_t size);
  void handle(const std::string& text);
  void handle_aside(std::string text);
  template <class Made>
  void work_aside(std::function<Made()> make, std::function<void(Client&, Made)> then,
                  std::function<void(Client&)> failed);
  void take(std::variant<Request, BadRequest> parsed, bool long_text);
  scene::TextLimits text_limits(std::size_t bytes) const;
  void pay(std::int64_t since);
  void ask_next_at_length();
  void stop_reading_if_due();
  void read_on();
  void schedule_frame(std::int64_t now);
  bool frame_goes_first();
  bool may_send() const;
  int send_close();
  int send_next();
  /// Begins to send a message, of which `owner` keeps the bytes.
  int write(std::shared_ptr<const void> owner, const unsigned char* data, std::size_t size, bool text);
  int write_piece();
  int send_frame(const stream::SharedMessage& frame);
  bool is_sending() const { return sending_.size > 0; }
  void account_unread();
  void forget_unread();

  Hub& hub_;
  lws* wsi_;
  std::uint64_t id_;
  std::string session_;
  std::string address_;
  std::int64_t since_ = session::now_us();
  std::uint64_t bytes_sent_ = 0;
  Role role_;
  Room* room_ = nullptr;
  bool greeted_ = false;
  std::string incoming_;  ///< the message being received, its fragments so far
  bool incoming_text_ = true;
  bool incoming_mesh_ = false;  ///< it is a mesh.upload, which may be longer than other messages
  std::weak_ptr<void> upload_;  ///< what begin_upload made last
  ServiceTime service_;
  Timer read_again_;
  bool reading_ = true;  ///< false: what the client sends stays in its socket
  bool aside_ = false;   ///< the workbench has something of the client's
  Outbox outbox_;
  std::deque<session::Command> long_asked_;  ///< of which each is asked when the one before is answered
  bool long_awaited_ = false;                ///< the session has one that it has not answered
  struct Sending {                           // a message of which pieces are still to be written
    std::shared_ptr<const void> owner;
    const unsigned char* data = nullptr;
    std::size_t size = 0, sent = 0;
    bool text = false;
  } sending_;
  MemoryBudget::Reservation unread_;  ///< of the answers in `outbox_`, in whole units
  std::int64_t took_last_ = since_;
  FramePacing pacing_;
  TokenBucket messages_;
  TokenBucket grab_notices_;    ///< a hand that moves may be wrong often: a notice a second is enough
  bool text_was_last_ = false;  ///< the last message sent was of the outbox
  bool topology_sent_ = false;
  std::uint32_t topology_revision_ = 0;
  std::uint32_t colliders_sent_for_ = 0;  ///< sequence number of the frame whose colliders were sent last
  bool frame_waits_ = false;
  int close_code_ = 0;
  bool close_sent_ = false;
  std::string close_reason_;
};

}  // namespace clothlab::net
