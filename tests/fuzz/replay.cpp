// The fuzz targets without libFuzzer: fuzz_replay TARGET FILE... runs each input of each packed file
// (corpus.mjs says how it is packed) through the target once.
#include "tests/fuzz/replay.h"

#include <cctype>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

namespace {

int digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/// Empty if a backslash is followed by what it never is.
std::optional<std::string> unescaped(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
      continue;
    }
    const char letter = ++i < text.size() ? text[i] : ' ';
    if (letter == '\\') {
      bytes += '\\';
    } else if (letter == 'n') {
      bytes += '\n';
    } else if (letter == 't') {
      bytes += '\t';
    } else if (letter == 'x' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      bytes += static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
      i += 2;
    } else {
      return std::nullopt;
    }
  }
  return bytes;
}

}  // namespace

int main(int count, char** arguments) {
  const auto target = clothlab::fuzz::targets.find(count > 1 ? arguments[1] : "");
  if (target == clothlab::fuzz::targets.end()) {
    std::fprintf(stderr, "fuzz_replay TARGET FILE...; targets are");
    for (const auto& [name, input] : clothlab::fuzz::targets) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  std::size_t inputs = 0;
  for (int i = 2; i < count; ++i) {
    std::ifstream file(arguments[i], std::ios::binary);
    for (std::string line; std::getline(file, line); ++inputs) {
      const std::size_t tab = line.find('\t');
      const std::optional<std::string> bytes =
          tab == std::string::npos ? std::nullopt : unescaped(std::string_view(line).substr(tab + 1));
      if (!bytes) {
        std::fprintf(stderr, "%s: line %zu is not packed by corpus.mjs\n", arguments[i], inputs + 1);
        return 1;
      }
      // The last name printed is that of the input that failed.
      std::fprintf(stderr, "%s\n", line.substr(0, tab).c_str());
      // Of its own size, so that a sanitizer sees what is read beyond the end.
      const std::vector<std::uint8_t> exact(bytes->begin(), bytes->end());
      target->second(exact.data(), exact.size());
    }
  }
  std::fprintf(stderr, "%zu inputs\n", inputs);
  return inputs == 0 ? 1 : 0;
}
