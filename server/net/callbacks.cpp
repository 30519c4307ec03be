#include "server/net/callbacks.h"

#include <libwebsockets.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <strings.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>

#include "server/base/log.h"
#include "server/net/client.h"
#include "server/net/frame_watch.h"
#include "server/net/http.h"
#include "server/net/request_checks.h"
#include "server/net/request_headers.h"
#include "server/net/server.h"

namespace clothlab::net {

namespace {

// libwebsockets keeps one of these structs, zeroed at first, for each connection: the object that handles it.
struct HttpSlot {
  HttpRequest* request;
  bool asked;  ///< the request's headers are complete, and it is not answered yet
};
struct ClientSlot {
  Client* client;
  bool ending;  ///< libwebsockets itself sends the close frame
};

Server& server_of(lws* wsi) {
  return *static_cast<Server*>(lws_context_user(lws_get_context(wsi)));
}

/// The reason phrase of an HTTP status; only people read it.
std::string reason(unsigned status) {
  switch (status) {
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 426:
      return "Upgrade Required";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Refused";
  }
}

/// Starts the timer that closes the connection unless the next request's headers are complete in time.
void await_request(lws* wsi) {
  lws_set_timer_usecs(wsi, lws_usec_t{server_of(wsi).hub().limits().header_seconds} * LWS_USEC_PER_SEC);
}

/// Returns what the callback of libwebsockets returns: -1 closes the connection.
int finish_http(HttpSlot& slot, lws* wsi, HttpRequest::Progress progress) {
  if (progress == HttpRequest::Progress::waits) return 0;
  delete slot.request;
  slot.request = nullptr;
  if (progress == HttpRequest::Progress::close || lws_http_transaction_completed(wsi))
    return -1;  // `slot` is invalid now
  if (lws_partial_buffered(wsi))
    lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, silence_seconds(server_of(wsi).hub().limits()));
  else
    await_request(wsi);
  return 0;
}

/// True while an answer is written in pieces.
bool sending(const HttpSlot* slot) {
  return slot && slot->request && slot->request->sending();
}

/// Ends a request that waited for a session.
void finish_late(lws* wsi, HttpRequest::Progress progress) {
  if (progress == HttpRequest::Progress::waits) return;  // for the socket to take the rest
  if (finish_http(*static_cast<HttpSlot*>(lws_wsi_user(wsi)), wsi, progress) != 0)
    lws_set_timeout(wsi, PENDING_TIMEOUT_KILLED_BY_PARENT, LWS_TO_KILL_ASYNC);
  lws_rx_flow_control(wsi, 1);
}

/// Refuses a new socket if too many are open. libwebsockets has no `lws` for the socket yet.
int on_socket(lws* wsi, int socket) {
  Hub& hub = server_of(wsi).hub();
  const std::string address = peer_address(socket);
  if (!hub.connections().full(address)) return 0;
  ++hub.metrics().refused;
  log(LogLevel::debug, "connection_refused", {{"address", address}, {"why", "too many connections"}});
  return -1;
}

int on_connection(lws* wsi) {
  Hub& hub = server_of(wsi).hub();
  watch_connection(lws_get_socket_fd(wsi));
  hub.connections().opened(wsi, peer_address(wsi));
  await_request(wsi);
  return 0;
}

/// Answers a handshake with an HTTP error. Returns -1, which closes the connection.
int refuse(lws* wsi, const RequestFault& fault) {
  constexpr std::size_t longest = 200;  // bytes of the Origin to log, so that no client fills the log
  ++server_of(wsi).hub().metrics().refused;
  server_of(wsi).hub().refusals().log(
      session::now_us(), {{"address", client_address(wsi, server_of(wsi).hub().options().trusted_proxies)},
                          {"origin", header(wsi, WSI_TOKEN_ORIGIN).substr(0, longest)},
                          {"status", std::to_string(fault.status)},
                          {"why", fault.why}});
  const std::string body = fault.why + "\n";
  std::string text(LWS_PRE, '\0');
  text += "HTTP/1.1 " + std::to_string(fault.status) + " " + reason(fault.status) +
          "\r\ncontent-type: text/plain; charset=utf-8\r\nx-content-type-options: nosniff\r\n"
          "connection: close\r\ncontent-length: " +
          std::to_string(body.size()) + "\r\n" + fault.extra_header + "\r\n" + body;
  lws_write(wsi, reinterpret_cast<unsigned char*>(text.data()) + LWS_PRE, text.size() - LWS_PRE,
            LWS_WRITE_HTTP_HEADERS);
  return -1;
}

/// Checks a request with an Upgrade header. Without this check libwebsockets would accept h2c, and would give
/// a handshake without a subprotocol the first protocol of its list.
int on_upgrade(lws* wsi, const char* to) {
  if (strcasecmp(to, "websocket") != 0) return -1;
  if (const std::optional<RequestFault> fault = request_fault(wsi)) return refuse(wsi, *fault);
  if (const std::optional<RequestFault> fault = handshake_fault(wsi)) return refuse(wsi, *fault);
  if (!watch_frames(wsi))
    return refuse(wsi, {400, "something came after the handshake; wait for its answer", {}});
  return 0;
}

int on_handshake(lws* wsi) {
  std::string why;
  const unsigned status = server_of(wsi).refusal(wsi, why);
  return status == 0 ? 0 : refuse(wsi, {status, why, status == 503 ? "retry-after: 1\r\n" : ""});
}

int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
  auto* slot = static_cast<HttpSlot*>(user);
  switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      return on_socket(wsi, static_cast<int>(reinterpret_cast<std::intptr_t>(in)));
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      return on_connection(wsi);
    case LWS_CALLBACK_WSI_DESTROY:
      server_of(wsi).hub().connections().closed(wsi);
      return 0;
    case LWS_CALLBACK_HTTP_BIND_PROTOCOL:  // also once the last of a long answer has been sent
      await_request(wsi);
      return 0;
    case LWS_CALLBACK_TIMER:
      if (sending(slot)) return slot->request->ask_socket(), 0;
      return slot && slot->asked ? 0 : -1;  // the request's headers have not come in time
    case LWS_CALLBACK_HTTP:
      if (sending(slot)) return 0;  // the answer has said that the connection will be closed
      slot->asked = true;
      delete slot->request;
      slot->request = new HttpRequest(server_of(wsi).hub(), server_of(wsi).files(), wsi, finish_late);
      return finish_http(*slot, wsi, slot->request->begin(std::string(static_cast<const char*>(in), size)));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return sending(slot) ? finish_http(*slot, wsi, slot->request->go_on()) : 0;
    case LWS_CALLBACK_CLOSED_HTTP:
      if (slot) finish_http(*slot, wsi, HttpRequest::Progress::close);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return on_upgrade(wsi, static_cast<const char*>(in));
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return -1;  // a WebSocket handshake for the subprotocol "http"
    case LWS_CALLBACK_RAW_ADOPT:
    case LWS_CALLBACK_RAW_RX:
      return -1;  // libwebsockets takes what follows a CONNECT request for raw bytes
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      server_of(wsi).hub().pump();
      return 0;
    default:
      return 0;
  }
}

/// Keeps the kernel's unsent bytes few, because a newer frame can no longer replace a frame among them.
void set_socket_options(lws* wsi) {
  const int socket = lws_get_socket_fd(wsi);
  const int unsent = unsent_kernel_bytes, yes = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

/// Answers a close frame that is not allowed. libwebsockets writes that answer itself and only takes the
/// reason.
int refuse_close(lws* wsi, std::string why) {
  lws_close_reason(wsi, LWS_CLOSE_STATUS_PROTOCOL_ERR, reinterpret_cast<unsigned char*>(why.data()),
                   why.size());
  return -1;
}

int on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
  auto* slot = static_cast<ClientSlot*>(user);
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return on_handshake(wsi);
    case LWS_CALLBACK_WSI_DESTROY:
      watch_no_longer(wsi);
      server_of(wsi).hub().connections().closed(wsi);
      return 0;
    case LWS_CALLBACK_ESTABLISHED:
      set_socket_options(wsi);
      slot->client = new Client(server_of(wsi).hub(), wsi, query(wsi, "session", main_session));
      return 0;
    case LWS_CALLBACK_RECEIVE:
      if (frame_fault(wsi)) return 0;
      return slot->client ? slot->client->receive(static_cast<const char*>(in), size) : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      if (slot->ending) return 0;
      if (const char* fault = frame_fault(wsi); fault && slot->client)
        slot->client->close(close_protocol, fault);
      return slot->client ? slot->client->writeable() : -1;
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
      if (const char* fault = frame_fault(wsi)) return slot->ending = true, refuse_close(wsi, fault);
      return slot->client && slot->client->close_sent() ? -1 : 0;
    case LWS_CALLBACK_TIMER:
      if (slot && slot->client) slot->client->timer();
      return 0;
    case LWS_CALLBACK_CLOSED:
      delete slot->client;
      slot->client = nullptr;
      return 0;
    default:
      return 0;
  }
}

// Exceptions must not pass through libwebsockets: after an exception the connection is closed.
template <int (*handler)(lws*, lws_callback_reasons, void*, void*, std::size_t)>
int guarded(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
  try {
    return handler(wsi, reason, user, in, size);
  } catch (const std::exception& error) {
    log(LogLevel::error, "connection_failed", {{"why", error.what()}});
    return -1;
  }
}

}  // namespace

const lws_protocols* protocols() {
  // A send() takes up to `send_bytes`; at 0, libwebsockets would slice frames to the receive buffer's size.
  constexpr std::size_t receive_bytes = 64 * 1024, send_bytes = 8 * 1024 * 1024;
  static const lws_protocols list[] = {
      {"http", guarded<on_http>, sizeof(HttpSlot), 4096, 0, nullptr, send_bytes},
      {subprotocol, guarded<on_client>, sizeof(ClientSlot), receive_bytes, 0, nullptr, send_bytes},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0},
  };
  return list;
}

}  // namespace clothlab::net
