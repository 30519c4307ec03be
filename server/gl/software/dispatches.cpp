#include "server/gl/buffer.h"
#include "server/gl/software/displays.h"

namespace clothlab::gl {

AnswersAtOnce AnswersAtOnce::of_device() {
  AnswersAtOnce made;
  made.answers_ = software_renderer();
  return made;
}

bool AnswersAtOnce::none(const Buffer& arguments, std::size_t offset) const {
  if (!answers_) return false;
  software::check_software("what a dispatch would do");
  std::uint32_t groups = 1;
  arguments.download(&groups, sizeof groups, offset);
  return groups == 0;
}

std::uint32_t fewest_lanes(const std::function<std::uint64_t(std::uint32_t threads)>& turns) {
  software::check_software("a small work group");
  constexpr std::uint64_t most_turns = 50000;  // how Mesa counts is not documented
  for (std::uint32_t lanes = 8; lanes <= 128; lanes *= 2)
    if (turns(lanes) < most_turns) return lanes;
  return 0;
}

}  // namespace clothlab::gl
