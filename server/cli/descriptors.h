// Connections and files take descriptors, of which the system allows a process so many. What the limits of
// clients need is asked for; where it is not given, they are lowered at the start, as a server without
// descriptors answers nobody.
#pragma once

#include "server/net/limits.h"

namespace clothlab::cli {

/// The descriptors that may be needed beside those of connections: the program's own, and those of each
/// session (its lock, its file while it is saved, its device). A relay's sessions have none.
int descriptors_beside_connections(const net::Limits& limits, bool relay);

/// The most clients for which `descriptors` are enough, with as many connections of plain HTTP beside them;
/// at most limits.clients, and of these at least 32: with so few descriptors, rather none are left now and
/// then.
int clients_within(int descriptors, const net::Limits& limits, bool relay);

/// Raises this process's soft limit of descriptors as far as it needs and may, and lowers limits.clients to
/// what the limit allows, which the log tells.
void fit_descriptors(net::Limits& limits, bool relay);

}  // namespace clothlab::cli
