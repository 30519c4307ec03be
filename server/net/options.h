// What `clothlab serve` is told on its command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/net/limits.h"
#include "server/scene/document.h"

namespace clothlab::net {

struct Options {
  scene::Document document;  ///< what every session starts with
  std::string bind = "127.0.0.1";
  int port = 8080;                        ///< 0: a free one
  std::string token;                      ///< empty: everybody is an operator
  std::string view_token;                 ///< for viewers, who change nothing
  std::vector<std::string> allow_origin;  ///< besides the server's own, e.g. "https://example.org"
  Limits limits;
  std::filesystem::path state_folder;  ///< where sessions are kept; empty: nowhere
  std::optional<int> gpu;
  std::string tls_certificate, tls_key;  ///< PEM files; empty: plain HTTP
};

/// 127.0.0.0/8, ::1 or localhost.
bool is_loopback(const std::string& address);

}  // namespace clothlab::net
