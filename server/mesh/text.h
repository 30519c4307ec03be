// Lines, words and numbers of a text that may be hostile. Internal to server/mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clothlab::mesh {

/// The lines of a text, which end in "\n", "\r\n" or "\r".
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text), size_(text.size()) {}
  /// Goes to the next line. False: there is none.
  bool next();
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }            ///< of this line, counted from 1
  std::size_t end() const { return size_ - rest_.size(); }  ///< where the next line begins

 private:
  std::string_view rest_, line_;
  std::size_t size_ = 0, number_ = 0;
};

/// Takes the next word, which spaces and tabs surround, off the front of `rest`; empty: there is none.
std::string_view next_word(std::string_view& rest);

/// The number that the whole word is, or nothing. "nan" and "inf" are numbers here.
std::optional<double> number_in(std::string_view word);
/// The place value of the last digit of a word that is a number: 0.01 of "1.25", 1e-05 of "2.50e-3".
double unit_of(std::string_view word);
std::optional<std::int64_t> integer_in(std::string_view word);

/// The word in quotation marks for a message: cut after 40 bytes, all but printable ASCII as "?".
std::string quoted(std::string_view word);
/// Without it std::quoted would be preferred where it is declared.
inline std::string quoted(const std::string& word) {
  return quoted(std::string_view(word));
}

/// The place of the first byte that no text has (a control character but tab), or npos.
std::size_t first_binary_byte(std::string_view line);

}  // namespace clothlab::mesh
