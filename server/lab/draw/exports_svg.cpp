#include "server/lab/draw/drawings.h"
#include "server/lab/exports.h"

namespace clothlab::lab {

namespace {
// Only charts and choices draw errors, so only they use `axis`.
std::string picture(const Chart& chart, Axis axis) {
  return draw(chart, axis);
}
std::string picture(const Choice& choice, Axis axis) {
  return draw(choice, axis);
}
std::string picture(const StabilityMap& map, Axis) {
  return draw(map);
}
std::string picture(const Simplification& simplification, Axis) {
  return draw(simplification);
}
std::string picture(const Comparison&, Axis) {
  return {};
}
}  // namespace

std::string svg(const Outcome& outcome, Axis axis) {
  return std::visit([axis](const auto& result) { return picture(result, axis); }, outcome);
}

}  // namespace clothlab::lab
