// What the server tells whoever started it: one line of logfmt on stderr for each event, made to be searched
// and to be read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace clothlab {

enum class LogLevel { error, warning, info, debug };

/// `value` may hold anything: it is quoted where it must be, and never spans lines.
struct LogField {
  const char* key;
  std::string value;
};

/// Writes `time=... level=... event=EVENT KEY=VALUE...` unless `level` is below what is wanted. Any thread.
void log(LogLevel level, const char* event, const std::vector<LogField>& fields = {});

/// info, unless set otherwise.
void set_log_level(LogLevel least);
/// By its name: error, warning, info or debug.
std::optional<LogLevel> log_level(const std::string& name);

}  // namespace clothlab
