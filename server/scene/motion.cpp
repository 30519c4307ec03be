#include "server/scene/sections.h"

namespace clothlab::scene {

Motion read_motion(const Reader& motion) {
  if (motion.is_null()) return std::monostate{};
  const Words kinds = {"oscillate", "linear", "spin"};
  motion.object(kinds);
  const std::string kind = motion.exactly_one(kinds);
  const Reader values = motion.member(kind);
  if (kind == "oscillate") {
    values.object({"axis", "amplitude", "frequency"});
    return Oscillate{values.member("axis").direction(), values.member("amplitude").number(ranges::amplitude),
                     values.member("frequency").number(ranges::frequency)};
  }
  if (kind == "linear") {
    values.object({"velocity"});
    return Linear{values.member("velocity").vector(ranges::velocity)};
  }
  values.object({"axis", "center", "degrees_per_second"});
  return Spin{values.member("axis").direction(), values.member("center").vector(ranges::position),
              values.member("degrees_per_second").number(ranges::angular_speed)};
}

}  // namespace clothlab::scene
