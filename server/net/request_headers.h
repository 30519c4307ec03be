// What a request says of itself, read from libwebsockets while it handles that request.
#pragma once

#include <libwebsockets.h>

#include <string>
#include <vector>

namespace clothlab::net {

/// Who is at the other end of a socket: an IPv4 or IPv6 address, empty where there is nobody any more.
std::string peer_address(int socket);
std::string peer_address(lws* wsi);
/// What limits count as one address: an IPv6 host has a network of 64 bits to itself, and any number of
/// addresses in it.
std::string network_of(const std::string& address);
/// A header's value, empty if it is missing; those of the same name are joined by commas.
std::string header(lws* wsi, lws_token_indexes token);
/// An argument of the query, `fallback` if it is missing.
std::string query(lws* wsi, const std::string& name, const std::string& fallback);

/// Whether a page from `origin` may connect: the page's own server, or one of `allowed`. No Origin is no
/// browser.
bool origin_allowed(const std::string& origin, const std::string& host,
                    const std::vector<std::string>& allowed);

/// Whether this Host header cannot be a hostile site's: an address, localhost, a name below that, or the host
/// of one of the `allowed` origins. A site may have any other name point at this machine (DNS rebinding), and
/// its pages then come from the "page's own server". No Host is no browser.
bool host_trusted(const std::string& host, const std::vector<std::string>& allowed);
/// A Host header for people to read: at most 200 characters, `?` for those that no name has.
std::string host_text(const std::string& host);

}  // namespace clothlab::net
