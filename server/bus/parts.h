// Messages larger than the bus takes at once travel in parts, each with its number among them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace clothlab::bus {

/// How many parts of at most `most` bytes (> 0) a message of `size` bytes has, at least 1.
std::size_t part_count(std::size_t size, std::size_t most);

/// As the parts' header says it: "2/5" is the second of five.
std::string part_label(std::size_t index, std::size_t count);

/// Puts messages together again. Parts of one subject come in order; if one is missing, its message is
/// dropped.
class Parts {
 public:
  /// Adds the next part of a message. Returns the whole message with its last part. `label` is empty for a
  /// message that came in one part.
  std::optional<std::vector<std::uint8_t>> add(const std::string& subject, const std::string& label,
                                               const std::uint8_t* data, std::size_t size);
  void forget(const std::string& subject) { begun_.erase(subject); }

  static constexpr std::size_t most_parts = 4096, most_bytes = std::size_t{256} << 20;

 private:
  struct Begun {
    std::size_t next = 1, count = 1;
    std::vector<std::uint8_t> bytes;
  };
  std::map<std::string, Begun> begun_;
};

}  // namespace clothlab::bus
