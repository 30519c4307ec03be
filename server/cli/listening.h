// What `clothlab serve` and `clothlab relay` share: the options of a server on a network, and its run until a
// signal.
#pragma once

#include <string>

#include "server/cli/commands.h"
#include "server/net/options.h"

namespace clothlab::cli {

struct Listening {
  net::Options options;
  std::string log_level = "info";
  std::string memory;  ///< of the process, as the user gave it; empty: what the system allows
};

/// Adds where to listen, who may connect, TLS and the log's level. `beyond_loopback` says what --bind needs
/// there.
void add_listening(CLI::App& command, Listening& listening, const std::string& beyond_loopback);

/// Adds one limit as a flag.
void add_limit(CLI::App& command, const char* flag, int& value, int least, int most, const char* help);
/// Adds the limits of connections and their messages.
void add_connection_limits(CLI::App& command, net::Limits& limits);

/// Adds --max-memory, which is shared out to what `uses` names.
void add_memory_limit(CLI::App& command, Listening& listening, const std::string& uses);
/// Bounds the memory of the process: `given` of it, or, if that is empty, what the system allows.
void bound_memory(net::Limits& limits, const std::string& given);

/// Error: options that contradict each other, or files that are none.
Status check_listening(const net::Options& options);

/// Serves until SIGINT or SIGTERM, and returns the exit code. No other thread may have been started before.
int listen_and_serve(Listening listening);

}  // namespace clothlab::cli
