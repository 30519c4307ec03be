#include "server/net/server.h"

#include <libwebsockets.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>

#include "server/base/log.h"
#include "server/base/log_bound.h"
#include "server/net/callbacks.h"
#include "server/net/request_checks.h"
#include "server/net/request_headers.h"

namespace clothlab::net {

namespace {

/// How long events are gathered before libwebsockets polls again, which it does for each event and over all
/// sockets: with many of them almost all of its time. A poll takes 0.15 us for each socket, about a hundredth
/// of this.
std::chrono::microseconds time_to_gather(std::size_t sockets) {
  constexpr std::size_t few = 16;
  constexpr std::chrono::microseconds for_each{10}, most{2000};
  if (sockets < few) return std::chrono::microseconds(0);
  return std::min(most, for_each * static_cast<int>(sockets));
}

/// What libwebsockets says: out of descriptors it says so at every look at the socket that listens. All on
/// the service thread.
LogBound& said_by_libwebsockets() {
  static LogBound bound(LogLevel::error, "libwebsockets");
  return bound;
}

bool is_ipv6(const std::string& address) {
  return address.find(':') != std::string::npos;
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.rfind("127.", 0) == 0;
}

// A connection that is silent for half of idle_seconds gets a ping; without a pong it is closed after
// idle_seconds, so that a client which has vanished without closing is noticed.
Server::Server(Options options)
    : keep_alive_{nullptr,
                  0,
                  0,
                  static_cast<std::uint16_t>((options.limits.idle_seconds + 1) / 2),
                  static_cast<std::uint16_t>(options.limits.idle_seconds),
                  0},
      hub_(std::move(options), [this] {
        if (lws_context* context = context_.load()) lws_cancel_service(context);
      }) {}

Server::~Server() {
  hub_.stop_sessions();
  if (lws_context* context = context_.exchange(nullptr)) lws_context_destroy(context);
}

Result<std::unique_ptr<Server>> Server::listen(Options options) {
  lws_set_log_level(LLL_ERR, [](int, const char* line) {
    std::string text = line;
    while (!text.empty() && text.back() == '\n') text.pop_back();
    said_by_libwebsockets().log(session::now_us(), {{"text", text}});
  });
  auto server = std::unique_ptr<Server>(new Server(std::move(options)));
  if (const Status joined = server->hub_.join_bus(); !joined) return joined.error();
  const Options& with = server->hub_.options();
  const std::string address = with.bind == "localhost" ? "127.0.0.1" : with.bind;
  lws_context_creation_info info{};
  info.port = with.port;
  info.iface = address.c_str();
  info.protocols = protocols();
  info.user = server.get();
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
  if (!is_ipv6(address)) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.pt_serv_buf_size = 256 * 1024;
  info.max_http_header_data2 = header_room_bytes;
  info.timeout_secs = static_cast<unsigned>(with.limits.header_seconds);
  info.timeout_secs_ah_idle = info.timeout_secs;
  info.keepalive_timeout = silence_seconds(with.limits);
  info.retry_and_idle_policy = &server->keep_alive_;
  info.alpn = "http/1.1";
  if (!with.tls_certificate.empty()) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = with.tls_certificate.c_str();
    info.ssl_private_key_filepath = with.tls_key.c_str();
    info.ssl_options_set = SSL_OP_NO_SSLv3 | SSL_OP_NO_TLSv1 | SSL_OP_NO_TLSv1_1;
  }
  lws_context* context = lws_create_context(&info);
  if (!context) return Error{"serve", "libwebsockets could not start", "see the lines above"};
  server->context_ = context;
  server->look_each_second();
  server->vhost_ = lws_create_vhost(context, &info);
  if (!server->vhost_)
    return Error{"serve", "cannot listen on " + with.bind + " port " + std::to_string(with.port),
                 "if another program uses it, choose another with --port, or --port 0 for any free one" +
                     std::string(with.tls_certificate.empty()
                                     ? ""
                                     : "; check that --tls-cert and --tls-key are PEM files")};
  return server;
}

void Server::look_each_second() {
  look_.server = this;
  const auto look = [](lws_sorted_usec_list_t* timer) {
    Server& server = *reinterpret_cast<Look*>(timer)->server;
    server.hub_.connections().excuse_slow_readers(silence_seconds(server.hub_.limits()));
    for (LogBound* bound : {&said_by_libwebsockets(), &server.hub_.refusals()})
      bound->tell_rest(session::now_us());
    server.look_each_second();
  };
  lws_sul_schedule(context_, 0, &look_.timer, look, LWS_USEC_PER_SEC);
}

std::string Server::url() const {
  const Options& with = hub_.options();
  const std::string host = is_ipv6(with.bind) ? "[" + with.bind + "]" : with.bind;
  return (with.tls_certificate.empty() ? "http://" : "https://") + host + ":" +
         std::to_string(lws_get_vhost_listen_port(vhost_)) + "/";
}

std::optional<session::Failed> Server::run(const std::function<void()>& ready) {
  if (!files_.built())
    log(LogLevel::warning, "page_not_built",
        {{"remedy", "npm --prefix web ci && npm --prefix web run build, or server/run"}});
  bool announced = hub_.opens_on_demand();
  if (announced)
    ready();
  else
    hub_.open_room(main_session);
  while (!stopping_) {
    if (lws_service(context_, 0) < 0) break;
    const std::chrono::microseconds pause = time_to_gather(hub_.connections().count());
    if (pause.count() > 0) std::this_thread::sleep_for(pause);
    hub_.give_up_sleeping_rooms();
    if (announced) continue;
    if (hub_.main_failure()) return hub_.main_failure();
    const Room* room = hub_.find_room(main_session);
    announced = room && room->started();
    if (announced) ready();
  }
  say_goodbye();
  return std::nullopt;
}

void Server::say_goodbye() {
  // With 1012 a client knows that it may come back at once: another server goes on with its session.
  constexpr int going_away = 1001;
  if (hub_.opens_on_demand())
    hub_.close_all(close_restart, "this server stops; another one goes on, connect again");
  else
    hub_.close_all(going_away, "the server is shutting down");
  const std::int64_t until = session::now_us() + 300'000;
  while (!hub_.empty() && session::now_us() < until) {
    lws_cancel_service(context_);  // so that lws_service returns soon
    if (lws_service(context_, 0) < 0) break;
  }
}

void Server::stop() {
  stopping_ = true;
  if (lws_context* context = context_.load()) lws_cancel_service(context);
}

unsigned Server::refusal(lws* wsi, std::string& why) {
  const std::string path = header(wsi, WSI_TOKEN_GET_URI);
  const std::string session = query(wsi, "session", main_session);
  if (path != "/ws") return why = "the WebSocket is at /ws", HTTP_STATUS_NOT_FOUND;
  if (!is_session_name(session))
    return why = "a session's name has 1 to 64 letters, digits, - or _", HTTP_STATUS_BAD_REQUEST;
  why = hub_.host_refusal(header(wsi, WSI_TOKEN_HOST));
  if (!why.empty()) return HTTP_STATUS_FORBIDDEN;
  if (!origin_allowed(header(wsi, WSI_TOKEN_ORIGIN), header(wsi, WSI_TOKEN_HOST),
                      hub_.options().allow_origin))
    return why = "pages of this origin may not connect; see --allow-origin", HTTP_STATUS_FORBIDDEN;
  if (stopping_) return why = "the server is shutting down", HTTP_STATUS_SERVICE_UNAVAILABLE;
  why = hub_.no_place(session, client_address(wsi, hub_.options().trusted_proxies));
  return why.empty() ? 0 : HTTP_STATUS_SERVICE_UNAVAILABLE;
}

}  // namespace clothlab::net
