#include "server/base/log.h"

#include <array>
#include <atomic>
#include <chrono>
#include <iostream>

#include "server/base/text.h"
#include "server/base/utc.h"

namespace clothlab {

namespace {

constexpr std::array<const char*, 4> names{"error", "warning", "info", "debug"};  // indexed by LogLevel
std::atomic<LogLevel> log_threshold{LogLevel::info};

std::string quoted(const std::string& value) {
  const auto plain = [](unsigned char c) {
    return c > ' ' && c != '"' && c != '=' && c != '\\' && c != 0x7F;
  };
  bool bare = !value.empty();
  std::string text = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    bare = bare && plain(byte);
    if (c == '"' || c == '\\')
      text += {'\\', c};
    else
      text += byte < ' ' || byte == 0x7F ? formatted("\\x%02x", byte) : std::string(1, c);
  }
  return bare ? value : text + "\"";
}

}  // namespace

void log(LogLevel level, const char* event, const std::vector<LogField>& fields) {
  if (level > log_threshold) return;
  std::string line = "time=" + utc_text(std::chrono::system_clock::now()) +
                     " level=" + names[static_cast<std::size_t>(level)] + " event=" + event;
  for (const LogField& field : fields) line += std::string(" ") + field.key + "=" + quoted(field.value);
  std::cerr << line + "\n" << std::flush;  // one write for the whole line, since other threads write too
}

void set_log_level(LogLevel least) {
  log_threshold = least;
}

std::optional<LogLevel> log_level(const std::string& name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i]) return static_cast<LogLevel>(i);
  return std::nullopt;
}

}  // namespace clothlab
