#include "server/net/request_headers.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace clothlab::net {

namespace {
std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_digit(unsigned char c) {
  return c >= '0' && c <= '9';
}

bool is_of_host(unsigned char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         std::string_view("-_.:[]").find(static_cast<char>(c)) != std::string_view::npos;
}

/// `host` without the port at its end, if any; empty if a colon is not followed by a port.
std::string without_port(const std::string& host) {
  const std::size_t bracket = host.rfind(']');  // colons before it belong to an IPv6 address
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  if (colon == std::string::npos) return host;
  const bool port = colon + 1 < host.size() &&
                    std::all_of(host.begin() + static_cast<std::ptrdiff_t>(colon) + 1, host.end(), is_digit);
  return port ? host.substr(0, colon) : std::string();
}

bool parses(int family, const std::string& address) {
  in6_addr parsed{};  // large enough for both families
  return inet_pton(family, address.c_str(), &parsed) == 1;
}

/// An IPv4 client of an IPv6 socket is known by its IPv4 address.
std::string text_of(const in6_addr& address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (IN6_IS_ADDR_V4MAPPED(&address))
    inet_ntop(AF_INET, address.s6_addr + 12, text, sizeof text);
  else
    inet_ntop(AF_INET6, &address, text, sizeof text);
  return text;
}

/// An address as a Host header has it.
bool is_address(const std::string& name) {
  if (name.starts_with('[') && name.ends_with(']')) return parses(AF_INET6, name.substr(1, name.size() - 2));
  return parses(AF_INET, name);
}
}  // namespace

std::string peer_address(int socket) {
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  if (getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &size) != 0) return {};
  char text[INET6_ADDRSTRLEN] = "";
  if (peer.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, text, sizeof text);
  } else if (peer.ss_family == AF_INET6) {
    return text_of(reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr);
  }
  return text;
}

std::string peer_address(lws* wsi) {
  return peer_address(lws_get_socket_fd(wsi));
}

bool is_ip_address(const std::string& text) {
  return parses(AF_INET, text) || parses(AF_INET6, text);
}

std::string plain_address(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  const bool bracket = text.starts_with('[');
  if (bracket || std::count(text.begin(), text.end(), ':') == 1) text = without_port(text);
  if (bracket) text = text.ends_with(']') ? text.substr(1, text.size() - 2) : std::string();
  in_addr four{};
  in6_addr six{};
  if (!bracket && inet_pton(AF_INET, text.c_str(), &four) == 1) return text;
  if (inet_pton(AF_INET6, text.c_str(), &six) != 1) return {};
  return text_of(six);
}

std::string client_address(lws* wsi, const std::vector<std::string>& trusted) {
  std::string address = peer_address(wsi);
  const auto is_proxy = [&] { return std::find(trusted.begin(), trusted.end(), address) != trusted.end(); };
  if (!is_proxy()) return address;
  std::string list = header(wsi, WSI_TOKEN_X_FORWARDED_FOR);
  while (is_proxy() && !list.empty()) {
    const std::size_t comma = list.rfind(',');
    const std::string last = plain_address(list.substr(comma == std::string::npos ? 0 : comma + 1));
    list.resize(comma == std::string::npos ? 0 : comma);
    if (last.empty()) break;
    address = last;
  }
  return address;
}

std::string network_of(const std::string& address) {
  in6_addr network{};
  if (inet_pton(AF_INET6, address.c_str(), &network) != 1) return address;
  if (IN6_IS_ADDR_V4MAPPED(&network)) return text_of(network);
  std::fill(network.s6_addr + 8, network.s6_addr + 16, std::uint8_t{0});
  char text[INET6_ADDRSTRLEN] = "";
  inet_ntop(AF_INET6, &network, text, sizeof text);
  return std::string(text) + "/64";
}

std::string header(lws* wsi, lws_token_indexes token) {
  const int length = lws_hdr_total_length(wsi, token);
  if (length <= 0) return {};
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  const int copied = lws_hdr_copy(wsi, text.data(), length + 1, token);
  text.resize(copied > 0 ? static_cast<std::size_t>(copied) : 0);
  return text;
}

std::string query(lws* wsi, const std::string& name, const std::string& fallback) {
  char buffer[256];
  const std::string key = name + "=";
  const char* value = lws_get_urlarg_by_name(wsi, key.c_str(), buffer, sizeof buffer);
  return value ? value : fallback;
}

bool origin_allowed(const std::string& origin, const std::string& host,
                    const std::vector<std::string>& allowed) {
  if (origin.empty()) return true;
  const std::string asked = lower(origin);
  const auto same = [&](const std::string& candidate) { return lower(candidate) == asked; };
  if (std::any_of(allowed.begin(), allowed.end(), same)) return true;
  return !host.empty() && (same("http://" + host) || same("https://" + host));
}

bool is_origin(const std::string& text) {
  const std::size_t scheme = text.find("://");
  if (scheme == std::string::npos) return false;
  const auto letter = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '+' || c == '.'; };
  return scheme > 0 && scheme + 3 < text.size() &&
         std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(scheme), letter) &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(scheme) + 3, text.end(), is_of_host);
}

bool host_trusted(const std::string& host, const std::vector<std::string>& allowed) {
  if (host.empty()) return true;
  const std::string asked = lower(host);
  const auto is_host_of = [&](const std::string& origin) {
    const std::size_t scheme = origin.find("://");
    return scheme != std::string::npos && lower(origin.substr(scheme + 3)) == asked;
  };
  if (std::any_of(allowed.begin(), allowed.end(), is_host_of)) return true;
  if (!std::all_of(asked.begin(), asked.end(), is_of_host)) return false;
  std::string name = without_port(asked);
  if (is_address(name)) return true;
  if (name.ends_with('.')) name.pop_back();  // "localhost." means localhost
  return name == "localhost" || name.ends_with(".localhost");
}

std::string host_text(const std::string& host) {
  constexpr std::size_t longest = 200;
  std::string text = host.substr(0, longest);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return !is_of_host(c); }, '?');
  return text;
}

}  // namespace clothlab::net
