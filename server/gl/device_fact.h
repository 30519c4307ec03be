// What is measured about a device instead of assumed, because devices and their drivers differ.
#pragma once

#include <functional>
#include <string>

namespace clothlab::gl {

/// The number `name` of the device of the calling thread's current context. The first call that asks for it
/// finds it out by `measure`; from then on it is kept, in memory and, by device and driver, in
/// `cache_folder("devices")`, for other runs of the program. To have it measured again, delete the file.
/// `measure` may ask for other facts. One thread measures at a time.
double device_fact(const std::string& name, const std::function<double()>& measure);

/// What two ways to do the same work take [s]: the least of several measurements of both in turn. What else
/// the machine does only ever adds to a time, and may last as long as all of them: a median would keep it.
struct TwoTimes {
  double one = 0.0, other = 0.0;
};
/// `one` and `other` queue their work `times` times: as often as the first one takes a millisecond for.
TwoTimes time_in_turn(const std::function<void(int times)>& one, const std::function<void(int times)>& other);

}  // namespace clothlab::gl
