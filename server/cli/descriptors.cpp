#include "server/cli/descriptors.h"

#include <sys/resource.h>

#include <algorithm>
#include <string>

#include "server/base/log.h"

namespace clothlab::cli {

namespace {
constexpr int connections_of_client = 2;  // as net::Connections allows
}

int descriptors_beside_connections(const net::Limits& limits, bool relay) {
  constexpr int own = 32, of_session = 8;
  return own + (relay ? 0 : of_session * limits.sessions);
}

int clients_within(int descriptors, const net::Limits& limits, bool relay) {
  constexpr int least = 32;
  const int left = descriptors - descriptors_beside_connections(limits, relay);
  return std::min(limits.clients, std::max(least, left / connections_of_client));
}

void fit_descriptors(net::Limits& limits, bool relay) {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  const int beside = descriptors_beside_connections(limits, relay);
  const auto wanted = static_cast<rlim_t>(connections_of_client * limits.clients + beside);
  constexpr rlim_t spare = 512;  // for what a driver may open
  if (files.rlim_cur < wanted + spare && files.rlim_cur < files.rlim_max) {
    files.rlim_cur = std::min(wanted + spare, files.rlim_max);
    setrlimit(RLIMIT_NOFILE, &files);
    if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  }
  if (files.rlim_cur >= wanted) return;
  const int asked = limits.clients;
  limits.clients = clients_within(static_cast<int>(files.rlim_cur), limits, relay);
  log(LogLevel::warning, "limit_lowered",
      {{"limit", "--max-clients"},
       {"from", std::to_string(asked)},
       {"to", std::to_string(limits.clients)},
       {"why", "this process may have " + std::to_string(files.rlim_cur) + " descriptors, and needs " +
                   std::to_string(wanted) + ": two for each client, " + std::to_string(beside) + " beside"},
       {"remedy",
        "allow it more (ulimit -Hn, LimitNOFILE= of systemd, --ulimit nofile= of docker run), or give a "
        "smaller --max-clients"}});
}

}  // namespace clothlab::cli
