// The beginning of a recording, as a recording.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/film/formats.h"

namespace clothlab::film {

/// What is left of it.
struct Kept {
  std::string title;  ///< the scene's name
  std::uint32_t frames = 0;
  double seconds = 0;  ///< when its last frame is shown
};

/// Hands on a recording of the frames of this one up to `time` [s] after its first, which each keep their
/// bits. Error: it is damaged.
Result<Kept> cut(std::string_view recording, double time, const Put& put);

}  // namespace clothlab::film
