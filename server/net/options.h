// The command-line options of `clothlab serve` and `clothlab relay`.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/net/limits.h"
#include "server/scene/document.h"

namespace clothlab::net {

struct Options {
  scene::Document document;  ///< the scene that every new session starts with
  bool usual_scene = false;  ///< nobody has named that scene: it is the program's own choice
  std::shared_ptr<const scene::Assets> assets;  ///< the meshes that scenes may name besides uploaded ones
  std::string bind = "127.0.0.1";
  int port = 8080;                        ///< 0: any free port
  std::string token;                      ///< makes a client an operator; empty: every client is one
  std::string view_token;                 ///< makes a client a viewer, who may change nothing; empty: none
  std::vector<std::string> allow_origin;  ///< origins allowed too, e.g. "https://example.org"
  Limits limits;
  std::filesystem::path state_folder;        ///< keeps the sessions' files; empty: sessions are not kept
  bool share_state = false;                  ///< other servers use that folder, too
  std::vector<std::string> trusted_proxies;  ///< addresses whose X-Forwarded-For is believed
  std::string bus;                           ///< the URL of a message bus; empty: none
  bool relay = false;  ///< sessions run on other servers, and come by the bus; else they are published on it
  std::optional<int> gpu;
  std::string tls_certificate, tls_key;  ///< PEM files; empty: plain HTTP
};

/// True for 127.0.0.0/8, ::1 and localhost.
bool is_loopback(const std::string& address);

}  // namespace clothlab::net
