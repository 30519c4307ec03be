// The server's log: one line of logfmt on stderr for each event, which a program can search and a person can
// read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace clothlab {

enum class LogLevel { error, warning, info, debug };

/// One KEY=VALUE of a line. `value` may hold any text: `log` quotes it where needed and keeps it on one line.
struct LogField {
  const char* key;
  std::string value;
};

/// Writes `time=... level=... event=EVENT KEY=VALUE...` unless `level` is less urgent than the level that
/// `set_log_level` set. Any thread may call it.
void log(LogLevel level, const char* event, const std::vector<LogField>& fields = {});

/// Sets the least urgent level that is written; info until the first call.
void set_log_level(LogLevel least);
/// The level with this name: error, warning, info or debug. No value for any other name.
std::optional<LogLevel> log_level(const std::string& name);

}  // namespace clothlab
