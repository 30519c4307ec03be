#include "server/net/request_checks.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/net/callbacks.h"
#include "server/net/frame_watch.h"
#include "server/net/request_headers.h"

namespace clothlab::net {

namespace {

/// The most bytes that libwebsockets reads of the lists in Connection and Sec-WebSocket-Protocol.
constexpr std::size_t longest_list = 120;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Returns the part of `text` before the first `separator`, trimmed; cuts that part and the separator off.
std::string_view cut_first(std::string_view& text, char separator) {
  const std::size_t at = text.find(separator);
  const std::string_view part = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
  return trimmed(part);
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

/// The weight q in an Accept-Encoding item's parameters, in [0, 1]; 1 if there is none. A malformed weight is
/// 0: without compression every client can read the answer.
double weight(std::string_view parameters) {
  while (!parameters.empty()) {
    const std::string_view parameter = cut_first(parameters, ';');
    if (parameter.size() < 2 || lower(parameter[0]) != 'q' || parameter[1] != '=') continue;
    double q = 0;
    const auto [end, failure] = std::from_chars(parameter.data() + 2, parameter.data() + parameter.size(), q);
    const bool whole = failure == std::errc() && end == parameter.data() + parameter.size();
    return whole && q >= 0 && q <= 1 ? q : 0;
  }
  return 1;
}

int header_bytes(lws* wsi) {
  int bytes = 0;
  for (int token = 0; token < WSI_TOKEN_COUNT; ++token)
    bytes += std::max(0, lws_hdr_total_length(wsi, static_cast<lws_token_indexes>(token)));
  return bytes;
}

bool has_header(lws* wsi, lws_token_indexes token) {
  return lws_hdr_total_length(wsi, token) > 0;
}

bool is_key(const std::string& text) {
  constexpr std::size_t length = 24;  // 16 bytes in base64
  const auto of_base64 = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '+' || c == '/';
  };
  return text.size() == length && text.ends_with("==") &&
         std::all_of(text.begin(), text.end() - 2, of_base64);
}

bool list_contains(std::string_view list, std::string_view wanted) {
  while (!list.empty())
    if (cut_first(list, ',') == wanted) return true;
  return false;
}

}  // namespace

std::optional<RequestFault> request_fault(lws* wsi) {
  if (const int bytes = header_bytes(wsi); bytes > max_header_bytes)
    return RequestFault{431,
                        "the request's headers have " + std::to_string(bytes) + " bytes, and may have " +
                            std::to_string(max_header_bytes) +
                            "; cookies of other programs on this host count: remove some, or use 127.0.0.1 "
                            "instead of localhost",
                        {}};
  if (head_malformed(wsi))
    return RequestFault{
        400, "a line of the request's head has no colon; send each header as NAME: VALUE", {}};
  if (header(wsi, WSI_TOKEN_HTTP) == "HTTP/1.1" && !has_header(wsi, WSI_TOKEN_HOST))
    return RequestFault{400, "the request has no Host header; HTTP/1.1 asks for one", {}};
  if (header(wsi, WSI_TOKEN_HOST).find(',') != std::string::npos)
    return RequestFault{400, "the request has several hosts; send one Host header", {}};
  const std::string length = header(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH);
  if (has_header(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) || length.find_first_not_of('0') != std::string::npos)
    if (has_header(wsi, WSI_TOKEN_GET_URI) || has_header(wsi, WSI_TOKEN_HEAD_URI))
      return RequestFault{
          400, "the request has a body; send it without Content-Length and Transfer-Encoding", {}};
  return std::nullopt;
}

std::optional<RequestFault> handshake_fault(lws* wsi) {
  const std::string wanted = std::string("; connect with the subprotocol ") + subprotocol;
  const std::string offered = header(wsi, WSI_TOKEN_PROTOCOL);
  if (offered.empty()) return RequestFault{400, "the handshake has no Sec-WebSocket-Protocol" + wanted, {}};
  if (!list_contains(offered, subprotocol))
    return RequestFault{400, "the handshake offers other subprotocols only" + wanted, {}};
  if (offered.size() > longest_list)
    return RequestFault{400,
                        "the handshake offers " + std::to_string(offered.size()) +
                            " bytes of subprotocols, and may offer " + std::to_string(longest_list) + wanted,
                        {}};
  if (header(wsi, WSI_TOKEN_VERSION) != "13")
    return RequestFault{426, "this server speaks version 13 of the WebSocket protocol (RFC 6455)",
                        "sec-websocket-version: 13\r\n"};
  if (!is_key(header(wsi, WSI_TOKEN_KEY)))
    return RequestFault{400, "the handshake has no Sec-WebSocket-Key of 16 bytes in base64", {}};
  std::string connection = header(wsi, WSI_TOKEN_CONNECTION);
  std::transform(connection.begin(), connection.end(), connection.begin(), lower);
  if (connection.size() > longest_list || !list_contains(connection, "upgrade"))
    return RequestFault{400, "the handshake has no `Connection: Upgrade`, or much else beside it", {}};
  return std::nullopt;
}

Coding preferred_coding(const std::string& accept_encoding, bool brotli_there) {
  std::optional<double> gzip, identity, any;
  double brotli = 0;
  std::string_view rest = accept_encoding;
  while (!rest.empty()) {
    std::string_view item = cut_first(rest, ',');
    const std::string_view coding = cut_first(item, ';');
    const double q = weight(item);
    if (equal_ignoring_case(coding, "gzip") || equal_ignoring_case(coding, "x-gzip")) gzip = q;
    if (equal_ignoring_case(coding, "br") && brotli_there) brotli = q;
    if (equal_ignoring_case(coding, "identity")) identity = q;
    if (coding == "*") any = q;
  }
  const double zip = gzip.value_or(any.value_or(0));
  // A client that does not name `identity` accepts no coding, but prefers the codings that it names.
  const double plain = identity.value_or(0);
  if (brotli > 0 && brotli >= zip && brotli >= plain) return Coding::brotli;
  return zip > 0 && zip >= plain ? Coding::gzip : Coding::identity;
}

}  // namespace clothlab::net
