#include "server/mesh/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace clothlab::mesh {

bool Lines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find_first_of("\r\n");
  line_ = rest_.substr(0, end);
  std::size_t taken = std::min(end, rest_.size());
  if (end != std::string_view::npos) taken += rest_.substr(end, 2) == "\r\n" ? 2 : 1;
  rest_.remove_prefix(taken);
  ++number_;
  return true;
}

std::string_view next_word(std::string_view& rest) {
  constexpr std::string_view blanks = " \t\v\f";
  const std::size_t begin = std::min(rest.find_first_not_of(blanks), rest.size());
  rest.remove_prefix(begin);
  const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
  rest.remove_prefix(word.size());
  return word;
}

namespace {

/// from_chars takes no leading "+", which other programs write.
template <class Number>
std::optional<Number> whole(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number number{};
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (failure != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<double> number_in(std::string_view word) {
  return whole<double>(word);
}

double unit_of(std::string_view word) {
  const std::size_t exponent = word.find_first_of("eE"), point = word.find('.');
  const std::string_view digits = word.substr(0, exponent);
  const auto decimals = point < digits.size() ? static_cast<std::int64_t>(digits.size() - point - 1) : 0;
  const std::int64_t power =
      exponent < word.size() ? integer_in(word.substr(exponent + 1)).value_or(0) : std::int64_t{0};
  return std::pow(10.0, static_cast<double>(power - decimals));
}

std::optional<std::int64_t> integer_in(std::string_view word) {
  return whole<std::int64_t>(word);
}

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string text(word.substr(0, longest));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return "\"" + text + (word.size() > longest ? "...\"" : "\"");
}

std::size_t first_binary_byte(std::string_view line) {
  const auto found = std::find_if(line.begin(), line.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\v' && c != '\f') || c == 0x7f;
  });
  return found == line.end() ? std::string_view::npos : static_cast<std::size_t>(found - line.begin());
}

}  // namespace clothlab::mesh
