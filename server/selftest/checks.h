// The checks by subject, each in a file of its own; selftest.cpp puts them in order.
#pragma once

#include <vector>

#include "server/selftest/places.h"
#include "server/selftest/report.h"
#include "server/selftest/scenes.h"

namespace clothlab::selftest {

/// Links every program of every preset, under every method that the preset suits (`quick`: its own; of the
/// seed all), of frames, fields, hands and pictures, and compares what they need with the device's limits.
void check_programs(Report& report, bool quick);

/// Where a short run ends, against the reference or the kept places.
Result<Check> check_scene(const ShortRun& run);
/// The places at the end of a run that has no reference, and how far another device may be from them.
Result<Places> places_of(const ShortRun& run);
/// Three runs from the start end in the same bits.
Result<Check> check_repeats(const ShortRun& run);

/// Frames of each encoding and field, decoded, against the state that they show.
void check_frames(Report& report, const ShortRun& run);

/// A picture, against the kept one.
Result<Check> check_picture(const ShortRun& run);
/// The mean colours of the cells of that picture.
Result<std::vector<double>> colours_of(const ShortRun& run);
inline constexpr const char* colours_file = "picture.json";

/// The time of stepping, at three sizes: told, not judged.
void tell_speed(Report& report, bool quick);

}  // namespace clothlab::selftest
