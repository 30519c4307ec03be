#include "server/net/client.h"

#include <libwebsockets.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/log.h"
#include "server/base/text.h"
#include "server/net/methods.h"
#include "server/net/request_headers.h"

namespace clothlab::net {

/// A client that is to wait does so at least this long [us], so that many do not wake the thread all the
/// time.
constexpr std::int64_t shortest_rest_us = 2000;

Client::Client(Hub& hub, lws* wsi, std::string session)
    : hub_(hub),
      wsi_(wsi),
      id_(hub.next_id()),
      session_(std::move(session)),
      address_(client_address(wsi, hub.options().trusted_proxies)),
      role_(hub.role_of("")),
      service_(hub.service(), own_service, network_of(address_), session::now_us()),
      read_again_(wsi, [this] { read_on(); }),
      unread_(std::move(*MemoryBudget::reserve(hub.limits().scene.memory, MemoryBudget::Use::downloads, 0))),
      messages_(hub.limits().message_rate, burst_of(hub.limits()), session::now_us()),
      grab_notices_(1, 3, session::now_us()) {
  const std::int64_t begun = thread_time_us();
  hub_.add(*this);
  log(LogLevel::info, "client_connected",
      {{"client", std::to_string(id_)}, {"address", address_}, {"session", session_}, {"role", name(role_)}});
  if (role_ == Role::none)
    lws_set_timer_usecs(wsi_, lws_usec_t{hub.limits().auth_seconds} * LWS_USEC_PER_SEC);
  else if (!enter_room())
    close_without_room();
  // All of it from what the address has: who comes anew each time would have a share of its own each time.
  hub_.service().spend(network_of(address_), session::now_us(), thread_time_us() - begun);
}

Client::~Client() {
  log(LogLevel::info, "client_left",
      {{"client", std::to_string(id_)},
       {"seconds", formatted("%.1f", 1e-6 * static_cast<double>(session::now_us() - since_))},
       {"bytes", std::to_string(bytes_sent_)},
       {"closed", close_reason_}});
  leave_room();
  hub_.remove(*this);
}

/// Closes a connection whose session cannot be opened here.
void Client::close_without_room() {
  if (hub_.elsewhere(session_))
    close(close_try_again, "another server has this session open");
  else
    close(close_policy, "too many sessions");
}

bool Client::enter_room() {
  room_ = hub_.open_room(session_);
  if (room_) room_->enter(*this);
  return room_ != nullptr;
}

void Client::leave_room() {
  pacing_.unsubscribe();
  long_asked_.clear();
  if (Room* room = room_) {
    room_ = nullptr;
    room->leave(*this);
  }
}

bool Client::admit(Role role) {
  if (role_ == Role::none) lws_set_timer_usecs(wsi_, LWS_SET_TIMER_USEC_CANCEL);
  role_ = role;
  log(LogLevel::info, "client_admitted", {{"client", std::to_string(id_)}, {"role", name(role)}});
  if (role != Role::operator_) {
    hub_.lab().client_left(id_);
    if (room_) room_->let_go(*this);
  }
  return room_ || enter_room();
}

void Client::timer() {
  if (role_ == Role::none) close(close_policy, "no token came in time");
  wake();
}

int Client::receive(const char* data, std::size_t size) {
  if (close_code_ != 0) return 0;  // the connection is being closed: drop what still comes
  {
    const Served served(*this);
    receive_part(data, size);
  }
  stop_reading_if_due();
  return 0;
}

void Client::receive_part(const char* data, std::size_t size) {
  if (lws_is_first_fragment(wsi_)) {
    incoming_.clear();
    incoming_text_ = !lws_frame_is_binary(wsi_);
    incoming_mesh_ = false;
  }
  std::size_t most = most_bytes({});
  const std::size_t begun = incoming_.size() + size + lws_remaining_packet_payload(wsi_);
  if (begun > most) most = most_bytes({data, size});
  if (begun > most) return refuse_too_long(most);
  incoming_.append(data, size);
  if (!lws_is_final_fragment(wsi_) || lws_remaining_packet_payload(wsi_) > 0) return;
  ++hub_.metrics().messages_received;
  if (!messages_.take(session::now_us(), price_of_message()))
    close(close_policy, "too many messages");
  else if (!incoming_text_)
    send(error_text(nullptr, {error_invalid_request, "only text messages are understood", nullptr}));
  else if (incoming_mesh_)
    handle_aside(std::move(incoming_));  // gives its memory back, too
  else
    handle(incoming_);
}

void Client::refuse_too_long(std::size_t most) {
  close(close_too_big, "a message may have " + std::to_string(most) + " bytes" +
                           (role_ == Role::none ? " before auth" : ""));
}

// Whether a message is a mesh.upload is known only once all of it is read; until then it is enough that it
// says so before it is too long for any other. `take` refuses a long one of another method.
std::size_t Client::most_bytes(std::string_view data) {
  const auto usual = static_cast<std::size_t>(hub_.limits().message_bytes);
  if (role_ == Role::none) return std::min(std::size_t{max_unadmitted_bytes}, usual);
  if (role_ == Role::operator_ && incoming_text_ && !incoming_mesh_) {
    constexpr std::string_view word = "\"mesh.upload\"";
    incoming_mesh_ = data.find(word) != std::string_view::npos ||
                     (!data.empty() && incoming_.find(word) != std::string::npos);
  }
  return incoming_mesh_ ? std::max(usual, session::max_upload_bytes) : usual;
}

/// A long message takes as long to read as many short ones, and counts as many; a mesh, as many as half of
/// those that may come at once.
double Client::price_of_message() const {
  const double units = std::ceil(static_cast<double>(incoming_.size()) / message_unit_bytes);
  return incoming_mesh_ ? std::min(units, burst_of(hub_.limits()) / 2.0) : units;
}

std::shared_ptr<void> Client::begin_upload() {
  if (!upload_.expired()) return nullptr;
  auto begun = std::make_shared<int>();
  upload_ = begun;
  return begun;
}

scene::TextLimits Client::text_limits(std::size_t bytes) const {
  const auto usual = static_cast<std::size_t>(hub_.limits().message_bytes);
  return {std::max(bytes, usual), static_cast<std::size_t>(hub_.limits().json_depth)};
}

void Client::handle(const std::string& text) {
  take(parse_request(text, text_limits(text.size())), false);
}

/// Has `make` run on the workbench, and `then` here with what it made, or `failed`. Until that nothing more
/// is read from the client.
template <class Made>
void Client::work_aside(std::function<Made()> make, std::function<void(Client&, Made)> then,
                        std::function<void(Client&)> failed) {
  aside_ = true;
  const auto with_client = [&hub = hub_, id = id_](const std::function<void(Client&)>& go_on) {
    Client* client = hub.find_client(id);
    if (!client) return;
    const Served served(*client);
    client->aside_ = false;
    go_on(*client);
    client->read_on();
  };
  hub_.workbench().add(
      [make = std::move(make), then = std::move(then), with_client]() -> Workbench::Ending {
        const auto made = std::make_shared<Made>(make());
        return [made, then, with_client] {
          with_client([&](Client& client) { then(client, std::move(*made)); });
        };
      },
      [failed = std::move(failed), with_client] { with_client(failed); });
}

/// Reads a long message aside, and carries it out.
void Client::handle_aside(std::string text) {
  using Parsed = std::variant<Request, BadRequest>;
  const bool is_long = text.size() > static_cast<std::size_t>(hub_.limits().message_bytes);
  work_aside<Parsed>(
      [limits = text_limits(text.size()), text = std::move(text)] { return parse_request(text, limits); },
      [is_long](Client& client, Parsed parsed) { client.take(std::move(parsed), is_long); },
      [](Client& client) {
        client.send(
            error_text(nullptr, {error_internal, "there was no memory to read the message", nullptr}));
      });
}

/// Carries out what a message asks for. `long_text`: it is longer than any message but a mesh.upload may be.
void Client::take(std::variant<Request, BadRequest> parsed, bool long_text) {
  if (const auto* bad = std::get_if<BadRequest>(&parsed)) {
    if (!bad->notification) send(error_text(bad->id, bad->error));
    return;
  }
  auto& request = std::get<Request>(parsed);
  if (long_text && request.method != "mesh.upload")
    return refuse_too_long(static_cast<std::size_t>(hub_.limits().message_bytes));
  request.received_us = session::now_us();
  const Outcome outcome = call(*this, request);
  if (const json* result = std::get_if<json>(&outcome)) answer(ticket(*this, request), *result);
  if (const auto* error = std::get_if<RpcError>(&outcome)) answer(ticket(*this, request), *error);
}

void Client::pay(std::int64_t since) {
  service_.spend(session::now_us(), thread_time_us() - since);
}

/// Leaves what the client sends in its socket while it has taken more of the service thread's time than is
/// its, while it does not read its answers, and while the workbench has something of it.
void Client::stop_reading_if_due() {
  if (!reading_ || close_code_ != 0) return;
  const std::int64_t wait = service_.wait(session::now_us());
  if (wait == 0 && !aside_ && !outbox_.crowded()) return;
  reading_ = false;
  ++hub_.metrics().reading_stopped;
  lws_rx_flow_control(wsi_, 0);
  if (wait > 0) read_again_.start(std::max(wait, shortest_rest_us));
}

/// Reads from the client again, unless it is still to wait.
void Client::read_on() {
  if (reading_) return;
  if (close_code_ == 0) {
    if (aside_ || outbox_.crowded()) return;  // who ends that calls this again
    if (const std::int64_t wait = service_.wait(session::now_us()); wait > 0)
      return read_again_.start(std::max(wait, shortest_rest_us));
  }
  reading_ = true;
  lws_rx_flow_control(wsi_, 1);
}

void Client::answer(const session::Ticket& ticket,
                    const std::variant<json, session::JsonText, RpcError>& answer) {
  const auto* result = std::get_if<json>(&answer);
  const auto* text = std::get_if<session::JsonText>(&answer);
  const auto* error = std::get_if<RpcError>(&answer);
  if (error && error->code == error_over_limit) ++hub_.metrics().over_limit;
  if (!ticket.id) {
    if (error && ticket.method.starts_with("grab.")) tell_refused_grab(ticket.method, *error);
    return;
  }
  // Unknown methods are not counted: a client could choose the metrics' labels with them.
  if (is_method(ticket.method))
    hub_.metrics().requests[ticket.method].add(1e-6 *
                                               static_cast<double>(session::now_us() - ticket.asked_us));
  send(result ? result_text(*ticket.id, *result)
       : text ? result_text(*ticket.id, *text)
              : error_text(*ticket.id, *error));
  if (!ticket.at_length) return;
  long_awaited_ = false;
  ask_next_at_length();
}

void Client::answer_aside(session::Ticket ticket, std::function<session::JsonText()> make) {
  work_aside<session::JsonText>(
      std::move(make), [ticket](Client& client, session::JsonText text) { client.answer(ticket, text); },
      [ticket](Client& client) {
        client.answer(ticket, RpcError{error_internal, "there was no memory to make the answer", nullptr});
      });
}

void Client::tell_refused_grab(const std::string& method, const RpcError& error) {
  if (!grab_notices_.take(session::now_us())) return;
  send(notification_text("notice", {{"level", "warning"}, {"text", method + ": " + error.message}}));
}

}  // namespace clothlab::net
