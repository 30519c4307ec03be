// The bus NATS (nats.io), by its C client library. A thread of our own sends, so that a bus which does not
// read delays nobody else; the library's threads receive.
#include <nats/nats.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "server/base/log.h"
#include "server/bus/bus.h"
#include "server/bus/parts.h"

namespace clothlab::bus {

namespace {

constexpr std::size_t most_waiting_bytes = std::size_t{64}
                                           << 20;  ///< to be sent; beyond, messages are dropped
constexpr std::size_t head_bytes = 4096;  ///< of a message beside its content and its note, generously
constexpr std::int64_t ping_ms = 2000, write_ms = 2000, again_ms = 250;
constexpr const char* note_header = "Clothlab-Note";
constexpr const char* part_header = "Clothlab-Part";

struct Freed {
  void operator()(natsOptions* options) const { natsOptions_Destroy(options); }
  void operator()(natsConnection* connection) const { natsConnection_Destroy(connection); }
  void operator()(natsSubscription* subscription) const { natsSubscription_Destroy(subscription); }
  void operator()(natsMsg* message) const { natsMsg_Destroy(message); }
};
template <class T>
using Owned = std::unique_ptr<T, Freed>;

std::string header_of(natsMsg* message, const char* key) {
  const char* value = nullptr;
  return natsMsgHeader_Get(message, key, &value) == NATS_OK && value ? value : "";
}

struct Subscribe {
  std::string subject;
  Keep keep;
};
struct Unsubscribe {
  std::string subject;
};
struct Send {
  Outgoing message;
  Keep keep;
};
using Order = std::variant<Send, Subscribe, Unsubscribe>;

class Nats final : public Bus {
 public:
  Nats(std::string url, std::function<void()> wake, std::size_t most_come)
      : url_(std::move(url)), wake_(std::move(wake)), most_come_bytes_(most_come) {}
  ~Nats() override { close(); }
  /// Error: the URL is none, or the bus refuses this client.
  Status open(const std::string& name);

  void send(Outgoing message, Keep keep) override;
  void subscribe(const std::string& subject, Keep keep) override { order(Subscribe{subject, keep}); }
  void unsubscribe(const std::string& subject) override { order(Unsubscribe{subject}); }
  void take(std::vector<Message>& out) override;
  Counts counts() const override;
  void close() override;

 private:
  natsStatus join(natsOptions* options);
  void order(Order order);
  void run();
  void carry_out(Send& send);
  void carry_out(Subscribe& subscribe);
  void carry_out(Unsubscribe& unsubscribe) { subscriptions_.erase(unsubscribe.subject); }
  bool publish(const Outgoing& message, std::size_t index, std::size_t count, std::size_t most);
  void receive(natsMsg* message);
  void changed(bool connected);
  void closed();

  static void on_message(natsConnection*, natsSubscription*, natsMsg* message, void* self) {
    const Owned<natsMsg> owned(message);
    static_cast<Nats*>(self)->receive(message);
  }
  static void on_connected(natsConnection*, void* self) { static_cast<Nats*>(self)->changed(true); }
  static void on_disconnected(natsConnection*, void* self) { static_cast<Nats*>(self)->changed(false); }
  static void on_closed(natsConnection*, void* self) { static_cast<Nats*>(self)->closed(); }
  static void on_error(natsConnection*, natsSubscription*, natsStatus status, void*) {
    log(LogLevel::warning, "bus_error", {{"why", natsStatus_GetText(status)}});
  }

  std::string url_;
  std::function<void()> wake_;
  const std::size_t most_come_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable orders_changed_;
  std::deque<Order> orders_;
  std::size_t waiting_bytes_ = 0;  ///< of the messages in `orders_`
  bool stopping_ = false;
  Counts counts_;
  std::map<std::string, Keep> keeps_;  ///< of the subjects subscribed to
  Parts parts_;
  std::deque<Message> come_;
  std::size_t come_bytes_ = 0;
  Owned<natsConnection> connection_;
  std::map<std::string, Owned<natsSubscription>> subscriptions_;  ///< used by the sending thread alone
  std::thread thread_;
};

/// The file of the certificates that are trusted: the environment's, else Debian's. Empty: none.
std::string trusted_certificates() {
  if (const char* named = std::getenv("SSL_CERT_FILE")) return named;
  const char* const usual = "/etc/ssl/certs/ca-certificates.crt";
  std::error_code failure;
  return std::filesystem::exists(usual, failure) ? usual : "";
}

/// True if trying again would not help.
bool refused(natsStatus status) {
  return status == NATS_CONNECTION_AUTH_FAILED || status == NATS_SSL_ERROR || status == NATS_INVALID_ARG ||
         status == NATS_ADDRESS_MISSING || status == NATS_SECURE_CONNECTION_REQUIRED ||
         status == NATS_SECURE_CONNECTION_WANTED;
}

/// The URL as it may be shown.
std::string without_password(const std::string& url) {
  const std::size_t slashes = url.find("//"), at = url.rfind('@');
  if (at == std::string::npos) return url;
  return (slashes == std::string::npos ? "" : url.substr(0, slashes + 2)) + url.substr(at + 1);
}

/// Connects; a bus that does not answer is tried again and again.
natsStatus Nats::join(natsOptions* options) {
  natsConnection* connection = nullptr;
  natsStatus status = natsConnection_Connect(&connection, options);
  if (status != NATS_OK && !refused(status)) {
    log(LogLevel::warning, "bus_away", {{"why", natsStatus_GetText(status)}});
    status = natsOptions_SetRetryOnFailedConnect(options, true, on_connected, this);
    if (status == NATS_OK) status = natsConnection_Connect(&connection, options);
  }
  connection_.reset(connection);
  if (status == NATS_OK) changed(true);
  return status == NATS_NOT_YET_CONNECTED ? NATS_OK : status;
}

Status Nats::open(const std::string& name) {
  natsOptions* made = nullptr;
  natsStatus status = natsOptions_Create(&made);
  const Owned<natsOptions> options(made);
  const auto set = [&](natsStatus next) {
    if (status == NATS_OK) status = next;
  };
  const bool tls = url_.starts_with("tls://");
  set(natsOptions_SetURL(made, url_.c_str()));
  set(natsOptions_SetName(made, name.c_str()));
  if (tls) set(natsOptions_SetSecure(made, true));
  if (const std::string file = trusted_certificates(); tls && !file.empty())
    set(natsOptions_LoadCATrustedCertificates(made, file.c_str()));
  set(natsOptions_SetMaxReconnect(made, -1));
  set(natsOptions_SetReconnectWait(made, again_ms));
  set(natsOptions_SetReconnectJitter(made, again_ms, again_ms));
  set(natsOptions_SetReconnectedCB(made, on_connected, this));
  set(natsOptions_SetDisconnectedCB(made, on_disconnected, this));
  set(natsOptions_SetErrorHandler(made, on_error, this));
  set(natsOptions_SetClosedCB(made, on_closed, this));
  set(natsOptions_SetPingInterval(made, ping_ms));
  set(natsOptions_SetMaxPingsOut(made, 2));
  set(natsOptions_SetWriteDeadline(made, write_ms));
  set(natsOptions_SetSendAsap(made, true));
  set(natsOptions_SetNoEcho(made, true));
  // One thread delivers the messages of all subscriptions, so they come in the order in which they were sent.
  set(natsOptions_UseGlobalMessageDelivery(made, true));
  if (status == NATS_OK) status = join(made);
  if (status != NATS_OK) {
    const char* why = nats_GetLastError(nullptr);
    return Error{"the bus at " + without_password(url_),
                 std::string(natsStatus_GetText(status)) + (why && *why ? ": " + std::string(why) : ""),
                 "an address, a user and a password that it accepts, as nats://USER:PASSWORD@127.0.0.1:4222"};
  }
  thread_ = std::thread([this] { run(); });
  return ok();
}

void Nats::close() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    counts_.connected = false;
  }
  orders_changed_.notify_one();
  if (thread_.joinable()) thread_.join();
  subscriptions_.clear();
  if (!connection_) return;
  natsConnection_Close(connection_.get());
  connection_.reset();
  nats_CloseAndWait(write_ms);  // for the library's threads, which call `wake_`
}

void Nats::changed(bool connected) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(counts_.connected, connected) == connected) return;
  }
  if (connected)
    log(LogLevel::info, "bus_connected", {});
  else
    log(LogLevel::warning, "bus_away", {{"why", "the connection was lost; it is made again"}});
}

/// The library gives up a bus that refuses this client twice, and closes the connection for good.
void Nats::closed() {
  {
    const std::lock_guard lock(mutex_);
    counts_.connected = false;
    if (stopping_) return;
  }
  log(LogLevel::error, "bus_closed",
      {{"why", "the bus refuses this client now; mend that, then start this program again"}});
}

void Nats::send(Outgoing message, Keep keep) {
  {
    const std::lock_guard lock(mutex_);
    if (keep == Keep::newest)
      for (Order& order : orders_)
        if (auto* waiting = std::get_if<Send>(&order);
            waiting && waiting->keep == Keep::newest && waiting->message.subject == message.subject) {
          waiting_bytes_ += message.bytes.size - waiting->message.bytes.size;
          waiting->message = std::move(message);
          ++counts_.dropped;
          return;
        }
    if (stopping_ || !counts_.connected || waiting_bytes_ + message.bytes.size > most_waiting_bytes) {
      ++counts_.dropped;
      return;
    }
    waiting_bytes_ += message.bytes.size;
    orders_.emplace_back(Send{std::move(message), keep});
  }
  orders_changed_.notify_one();
}

void Nats::order(Order order) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto* subscribe = std::get_if<Subscribe>(&order)) keeps_[subscribe->subject] = subscribe->keep;
    if (const auto* unsubscribe = std::get_if<Unsubscribe>(&order)) {
      keeps_.erase(unsubscribe->subject);
      parts_.forget(unsubscribe->subject);
    }
    orders_.push_back(std::move(order));
  }
  orders_changed_.notify_one();
}

void Nats::run() {
  constexpr std::chrono::milliseconds tick{250};
  auto next_tick = std::chrono::steady_clock::now() + tick;
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    orders_changed_.wait_until(lock, next_tick, [&] { return stopping_ || !orders_.empty(); });
    if (!orders_.empty() && !stopping_) {
      Order order = std::move(orders_.front());
      orders_.pop_front();
      if (const auto* send = std::get_if<Send>(&order)) waiting_bytes_ -= send->message.bytes.size;
      lock.unlock();
      std::visit([&](auto& what) { carry_out(what); }, order);
      lock.lock();
    }
    if (const auto now = std::chrono::steady_clock::now(); now >= next_tick) {
      next_tick = now + tick;
      lock.unlock();
      wake_();
      lock.lock();
    }
  }
}

void Nats::carry_out(Subscribe& subscribe) {
  Owned<natsSubscription>& subscription = subscriptions_[subscribe.subject];
  if (subscription) return;
  natsSubscription* made = nullptr;
  const natsStatus status =
      natsConnection_Subscribe(&made, connection_.get(), subscribe.subject.c_str(), on_message, this);
  subscription.reset(made);
  if (status == NATS_OK) return;
  subscriptions_.erase(subscribe.subject);
  log(LogLevel::error, "bus_error", {{"subject", subscribe.subject}, {"why", natsStatus_GetText(status)}});
}

void Nats::carry_out(Send& send) {
  const Outgoing& message = send.message;
  const std::int64_t taken = natsConnection_GetMaxPayload(connection_.get());
  const std::size_t most = taken > 0 ? static_cast<std::size_t>(taken) : std::size_t{1} << 20;
  const std::size_t head = head_bytes + message.note.size();
  bool sent = natsConnection_Status(connection_.get()) == NATS_CONN_STATUS_CONNECTED && 2 * head < most;
  if (sent) {
    const std::size_t count = part_count(message.bytes.size, most - head);
    for (std::size_t i = 0; i < count && sent; ++i) sent = publish(message, i, count, most - head);
  }
  const std::lock_guard lock(mutex_);
  if (!sent) return void(++counts_.dropped);
  ++counts_.sent;
  counts_.sent_bytes += message.bytes.size;
}

bool Nats::publish(const Outgoing& message, std::size_t index, std::size_t count, std::size_t most) {
  const std::size_t from = index * most, size = std::min(most, message.bytes.size - from);
  natsMsg* made = nullptr;
  natsStatus status =
      natsMsg_Create(&made, message.subject.c_str(), message.reply.empty() ? nullptr : message.reply.c_str(),
                     reinterpret_cast<const char*>(message.bytes.data) + from, static_cast<int>(size));
  const Owned<natsMsg> owned(made);
  if (status == NATS_OK && !message.note.empty())
    status = natsMsgHeader_Set(made, note_header, message.note.c_str());
  if (status == NATS_OK && count > 1)
    status = natsMsgHeader_Set(made, part_header, part_label(index + 1, count).c_str());
  return status == NATS_OK && natsConnection_PublishMsg(connection_.get(), made) == NATS_OK;
}

void Nats::receive(natsMsg* from) {
  Message message;
  message.subject = natsMsg_GetSubject(from);
  if (const char* reply = natsMsg_GetReply(from)) message.reply = reply;
  message.note = header_of(from, note_header);
  message.unheard = natsMsg_IsNoResponders(from);
  bool alone = false;  // who takes what has come takes all of it: one call for many is enough
  {
    const std::lock_guard lock(mutex_);
    const auto keep = keeps_.find(message.subject);
    if (keep == keeps_.end()) return;
    std::optional<std::vector<std::uint8_t>> whole =
        parts_.add(message.subject, header_of(from, part_header),
                   reinterpret_cast<const std::uint8_t*>(natsMsg_GetData(from)),
                   static_cast<std::size_t>(natsMsg_GetDataLength(from)));
    if (!whole) return;
    message.bytes = std::move(*whole);
    if (keep->second == Keep::newest) {
      const auto older = std::find_if(come_.begin(), come_.end(),
                                      [&](const Message& each) { return each.subject == message.subject; });
      if (older != come_.end()) {
        come_bytes_ -= older->bytes.size();
        come_.erase(older);
      }
    }
    if (come_bytes_ + message.bytes.size() > most_come_bytes_) return;
    come_bytes_ += message.bytes.size();
    alone = come_.empty();
    come_.push_back(std::move(message));
  }
  if (alone) wake_();
}

void Nats::take(std::vector<Message>& out) {
  out.clear();
  const std::lock_guard lock(mutex_);
  out.insert(out.end(), std::make_move_iterator(come_.begin()), std::make_move_iterator(come_.end()));
  come_.clear();
  come_bytes_ = 0;
}

Counts Nats::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace

Result<std::unique_ptr<Bus>> connect(const std::string& url, const std::string& name,
                                     std::function<void()> wake, std::size_t most_come) {
  if (!url.starts_with("nats://") && !url.starts_with("tls://"))
    return Error{"the bus", "\"" + without_password(url) + "\"",
                 "an address such as nats://127.0.0.1:4222, or tls://..."};
  auto bus = std::make_unique<Nats>(url, std::move(wake), most_come);
  if (const Status opened = bus->open(name); !opened) return opened.error();
  return Result<std::unique_ptr<Bus>>(std::move(bus));
}

std::string library() {
  return std::string("nats ") + nats_GetVersion();
}

}  // namespace clothlab::bus
