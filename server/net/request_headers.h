// A request's sender, headers and arguments, read while libwebsockets handles the request, and the checks of
// its Origin and Host.
#pragma once

#include <libwebsockets.h>

#include <string>
#include <vector>

namespace clothlab::net {

/// The IPv4 or IPv6 address at the other end of a socket; empty if the connection has ended.
std::string peer_address(int socket);
std::string peer_address(lws* wsi);
/// The client's address: the one at the other end or, where that is one of the `trusted` proxies, the last in
/// X-Forwarded-For that is none of them, with or without a port. Each proxy appends the address that it was
/// reached from, so that what a client writes there itself comes before, and is never read.
std::string client_address(lws* wsi, const std::vector<std::string>& trusted);
/// True for an IPv4 or IPv6 address, without a port.
bool is_ip_address(const std::string& text);
/// The address in a text as proxies write it, alone, with a port, or in brackets, in one form for each
/// address: 192.0.2.7 also for ::ffff:192.0.2.7; empty if it is none.
std::string plain_address(std::string text);
/// The name under which limits count an address: an IPv4 address itself, but an IPv6 address's /64 network,
/// because one host can use all addresses of its /64 network.
std::string network_of(const std::string& address);
/// A header's value; empty if the header is missing. Headers of the same name are joined by commas.
std::string header(lws* wsi, lws_token_indexes token);
/// The value of the argument `name` in the URL's query; `fallback` if it is missing.
std::string query(lws* wsi, const std::string& name, const std::string& fallback);

/// True if a page from `origin` may connect: a page of this server, which the request calls `host`, or of an
/// `allowed` origin. An empty `origin` is allowed: browsers always send one with a WebSocket handshake.
bool origin_allowed(const std::string& origin, const std::string& host,
                    const std::vector<std::string>& allowed);

/// True if `text` has the form of an origin, such as https://host:8080, so that a header may name it.
bool is_origin(const std::string& text);

/// True if this Host header cannot name a hostile site: it is an IP address, localhost, a name below
/// localhost, or the host of an `allowed` origin. A site can make any other name point at this machine (DNS
/// rebinding), and its pages would then count as this server's own. An empty `host` is trusted: browsers
/// always send one.
bool host_trusted(const std::string& host, const std::vector<std::string>& allowed);
/// A Host header for messages: at most 200 characters, with `?` for characters that no host name has.
std::string host_text(const std::string& host);

}  // namespace clothlab::net
