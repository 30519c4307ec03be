// How an answer is sent: its head, and its body at once or a piece at a time.
#include <libwebsockets.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <utility>

#include "server/net/http.h"
#include "server/net/hub.h"
#include "server/net/limits.h"
#include "server/net/request_headers.h"

namespace clothlab::net {

namespace {

// The page runs only its own scripts and styles, and talks to this server alone.
constexpr const char* content_security_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action "
    "'none'; "
    "frame-ancestors 'self'";

constexpr std::pair<const char*, const char*> security_headers[] = {
    {"x-content-type-options:", "nosniff"},
    {"referrer-policy:", "no-referrer"},
    {"cross-origin-opener-policy:", "same-origin"},
    {"cross-origin-resource-policy:", "same-origin"},
    {"permissions-policy:", "camera=(), display-capture=(), geolocation=(), microphone=(), usb=()"},
};

/// Adds to `headers` what lets pages of the allowed origins, a notebook's for example, show this server's
/// page in a frame; nobody else may. (X-Frame-Options can name no origin.)
void add_framing(std::vector<std::pair<std::string, std::string>>& headers,
                 const std::vector<std::string>& allowed) {
  std::string policy = content_security_policy;
  for (const std::string& origin : allowed)
    if (is_origin(origin)) policy += " " + origin;
  headers.emplace_back("content-security-policy:", policy);
  if (allowed.empty()) headers.emplace_back("x-frame-options:", "SAMEORIGIN");
}

/// A longer body is written in pieces of `piece_bytes`, each when the socket takes it, from one copy that all
/// who get it share: somebody who does not read costs one piece. The connection then ends. Shorter ones, all
/// files of the page among them, are handed to libwebsockets whole, and the next request may follow.
constexpr std::size_t most_at_once = 1024 * 1024;

}  // namespace

HttpRequest::Progress HttpRequest::refuse(const HttpAnswer& refusal) {
  last_ = true;
  send(refusal);
  return Progress::close;
}

// The headers and as much of the body as one piece has in one write: libwebsockets keeps what the socket does
// not take yet. After an answer in pieces the connection is closed: while nothing is read, libwebsockets does
// not say that the socket takes more, and what is read is the next request, which is not answered then.
HttpRequest::Progress HttpRequest::send(HttpAnswer answer) {
  if (!answer.shared) {
    if (answer.body.size() > most_at_once)
      if (std::optional<HttpAnswer> why = reserve(MemoryBudget::Use::downloads, answer.body.size()))
        answer = std::move(*why);
    answer.shared = std::make_shared<const std::string>(std::move(answer.body));
  }
  const std::string& body = *answer.shared;
  if (!head_ && body.size() > most_at_once) last_ = true;
  std::vector<std::pair<std::string, std::string>> headers = answer.headers;
  add_framing(headers, hub_.options().allow_origin);
  if (!reader_.empty())
    headers.insert(headers.end(), {{"access-control-allow-origin:", reader_}, {"vary:", "origin"}});
  std::size_t longest_headers = 4096;
  for (const auto& [name, value] : headers) longest_headers += name.size() + value.size() + 4;
  std::vector<unsigned char> bytes(LWS_PRE + longest_headers);
  unsigned char *const start = bytes.data() + LWS_PRE, *at = start, *const end = start + longest_headers - 1;
  const auto add = [&](const char* name, const std::string& value) {
    return lws_add_http_header_by_name(wsi_, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end);
  };
  int failed = lws_add_http_header_status(wsi_, answer.status, &at, end);
  failed |= add("content-type:", answer.type);
  failed |= lws_add_http_header_content_length(wsi_, body.size(), &at, end);
  if (last_) failed |= add("connection:", "close");
  if (!file_name_.empty() && answer.status == 200)
    failed |= add("content-disposition:", "attachment; filename=\"" + file_name_ + "\"");
  for (const auto& [name, value] : security_headers) failed |= add(name, value);
  for (const auto& [name, value] : headers) failed |= add(name.c_str(), value);
  if (failed || lws_finalize_http_header(wsi_, &at, end)) return Progress::close;
  bytes.resize(static_cast<std::size_t>(at - bytes.data()));
  const std::size_t first = head_ ? 0 : body.size() > most_at_once ? piece_bytes : body.size();
  bytes.insert(bytes.end(), body.begin(), body.begin() + static_cast<std::ptrdiff_t>(first));
  if (lws_write(wsi_, bytes.data() + LWS_PRE, bytes.size() - LWS_PRE, LWS_WRITE_HTTP_HEADERS) < 0)
    return Progress::close;
  if (head_ || first == body.size()) return Progress::answered;
  rest_ = std::move(answer.shared);
  sent_ = first;
  keep_unsent_few();
  lws_rx_flow_control(wsi_, 1);  // as without it libwebsockets does not say that the socket takes more
  await_socket();
  return Progress::waits;
}

/// Keeps the kernel from taking megabytes that nobody reads.
void HttpRequest::keep_unsent_few() const {
  const int unsent = unsent_kernel_bytes;
  setsockopt(lws_get_socket_fd(wsi_), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
}

/// The limit of time is for silence: it begins anew with each piece.
void HttpRequest::await_socket() const {
  lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, http_patience);
  ask_socket();
}

// libwebsockets forgets that it was asked while it has bytes of its own to write: so it is asked again.
void HttpRequest::ask_socket() const {
  constexpr lws_usec_t again = LWS_USEC_PER_SEC / 10;
  lws_callback_on_writable(wsi_);
  lws_set_timer_usecs(wsi_, again);
}

HttpRequest::Progress HttpRequest::go_on() {
  if (sent_ == rest_->size()) return Progress::close;  // the kernel has it all
  const std::size_t size = std::min(piece_bytes, rest_->size() - sent_);
  std::vector<unsigned char> bytes(LWS_PRE + size);
  std::copy_n(rest_->data() + sent_, size, bytes.data() + LWS_PRE);
  sent_ += size;
  if (lws_write(wsi_, bytes.data() + LWS_PRE, size, LWS_WRITE_HTTP) < 0) return Progress::close;
  await_socket();
  return Progress::waits;
}

}  // namespace clothlab::net
