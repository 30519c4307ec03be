// Catch2 version 2 or 3, whichever the distribution has, under the names of version 3.
// And how thorough a run of the tests is.
#pragma once

#include <cstdlib>

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
using Catch::Matchers::ContainsSubstring;
#else
#include <catch2/catch.hpp>
#include <string>
inline auto ContainsSubstring(const std::string& part) {
  return Catch::Contains(part);
}
#endif

namespace clothlab::test {

/// True with CLOTHLAB_THOROUGH in the environment (tests/all): claims are tried on all that they are about.
/// Otherwise, as in continuous integration, the dearest are tried on a part of it.
inline bool thorough() {
  return std::getenv("CLOTHLAB_THOROUGH") != nullptr;
}

/// Which of a claim's combinations, say of scene and method, are tried unless all are: the first of each
/// `every` in their order.
class Part {
 public:
  explicit Part(int every) : every_(every) {}
  /// Asked once for each combination.
  bool leaves_out() { return number_++ % every_ != 0 && !thorough(); }

 private:
  int every_, number_ = 0;
};

}  // namespace clothlab::test
