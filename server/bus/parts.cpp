#include "server/bus/parts.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace clothlab::bus {

namespace {

/// The numbers of a label "INDEX/COUNT", both at least 1 and INDEX at most COUNT; no value for any other
/// text.
std::optional<std::pair<std::size_t, std::size_t>> numbers(const std::string& label) {
  std::size_t index = 0, count = 0;
  const char* const end = label.data() + label.size();
  const auto [slash, bad_index] = std::from_chars(label.data(), end, index);
  if (bad_index != std::errc() || slash == end || *slash != '/') return std::nullopt;
  const auto [rest, bad_count] = std::from_chars(slash + 1, end, count);
  if (bad_count != std::errc() || rest != end || index < 1 || index > count || count > Parts::most_parts)
    return std::nullopt;
  return std::pair(index, count);
}

}  // namespace

std::size_t part_count(std::size_t size, std::size_t most) {
  return std::max<std::size_t>(1, (size + most - 1) / most);
}

std::string part_label(std::size_t index, std::size_t count) {
  return std::to_string(index) + "/" + std::to_string(count);
}

std::optional<std::vector<std::uint8_t>> Parts::add(const std::string& subject, const std::string& label,
                                                    const std::uint8_t* data, std::size_t size) {
  if (label.empty()) {
    begun_.erase(subject);
    return std::vector<std::uint8_t>(data, data + size);
  }
  const auto part = numbers(label);
  if (part && part->first == 1) begun_[subject] = {1, part->second, {}};
  const auto found = begun_.find(subject);
  if (found == begun_.end()) return std::nullopt;
  Begun& begun = found->second;
  if (!part || part->first != begun.next || part->second != begun.count ||
      begun.bytes.size() + size > most_bytes) {
    begun_.erase(found);
    return std::nullopt;
  }
  begun.bytes.insert(begun.bytes.end(), data, data + size);
  if (begun.next++ < begun.count) return std::nullopt;
  std::vector<std::uint8_t> whole = std::move(begun.bytes);
  begun_.erase(found);
  return whole;
}

}  // namespace clothlab::bus
