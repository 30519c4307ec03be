// Shared by the fuzz targets. A target is a file with LLVMFuzzerTestOneInput: under clang it is linked with
// libFuzzer, otherwise all are linked with replay.cpp, which runs one over its inputs of tests/fuzz/corpus.
// Its checks hold for every input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/base/result.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace clothlab::fuzz {

/// Ends the program if a property does not hold; libFuzzer then keeps the input.
inline void require(bool holds, const char* property, const std::string& found = "") {
  if (holds) return;
  std::fprintf(stderr, "property broken: %s%s%s\n", property, found.empty() ? "" : ": ", found.c_str());
  std::abort();
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Returns the text up to the next newline, and removes both from `rest`.
inline std::string next_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  const std::string line(rest.substr(0, end));
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return line;
}

inline bool is_utf8(const std::string& text) {
  try {
    (void)nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

/// The error says what was found and what to do, in text that can be shown. An empty `where` is the whole
/// document.
inline void require_complete(const Error& error) {
  require(!error.what.empty() && !error.remedy.empty(), "an error says what was found and what is allowed",
          error.text());
}

}  // namespace clothlab::fuzz
