// What the server tells whoever started it: lines on stderr, like the rest of the program's notes.
#pragma once

#include <iostream>
#include <string>

namespace clothlab::net {

inline void log(const std::string& text) {
  std::cerr << "clothlab: " + text + "\n" << std::flush;
}

}  // namespace clothlab::net
