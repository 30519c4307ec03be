// Reads the keys of the scene document, and checks them against the scene that they are of.
#include <algorithm>
#include <limits>

#include "server/base/text.h"
#include "server/scene/keys.h"
#include "server/scene/pointer.h"
#include "server/scene/sections.h"

namespace clothlab::scene {

namespace {

dvec3 read_value(const Reader& value, const Keyed& place) {
  if (place.held) return dvec3(value.boolean(true) ? 1.0 : 0.0, 0.0, 0.0);
  if (place.vector) return value.vector(place.range);
  const double number = value.number(place.range);
  if (place.above_zero && !(number > 0.0))
    value.fail("above 0: at 0 there would be no such elements; a small number makes them slack");
  return dvec3(number, 0.0, 0.0);
}

void read_keyframes(const Reader& frames, const Keyed& place, Key& key) {
  const std::size_t count = frames.array(1, max_keyframes);
  for (std::size_t i = 0; i < count && !frames.failed(); ++i) {
    const Reader frame = frames.element(i);
    if (frame.array(2, 2) != 2) return;
    const Reader time = frame.element(0), value = frame.element(1);
    key.times.push_back(time.number(ranges::key_time));
    if (i > 0 && !(key.times[i] > key.times[i - 1]))
      time.fail("above " + with_significant_digits(key.times[i - 1], 6) +
                ", the time before: times rise, and two values at one time are a jump, \"ease\": \"step\"");
    key.values.push_back(read_value(value, place));
    if (!place.held) continue;
    if (i == 0 && key.values[0].x == 0.0) value.fail("true: a pin holds at first; without that, no pin");
    if (i > 0 && key.values[i].x > key.values[i - 1].x)
      value.fail("false: a pin that has let go does not catch its vertices again");
  }
}

Ease read_ease(const Reader& key, const Keyed& place) {
  const Reader ease = key.member("ease", place.held ? "step" : "linear");
  const std::string text = ease.choice({"linear", "smooth", "step"});
  if (place.held && text != "step") ease.fail("\"step\": between true and false is nothing");
  return text == "smooth" ? Ease::smooth : text == "step" ? Ease::step : Ease::linear;
}

/// Of the keys of a number: its smallest and its largest value, or `otherwise` without a key.
std::pair<double, double> bounds(const Scene& scene, const std::string& of, double otherwise) {
  for (const Key& key : scene.keys) {
    if (key.of != of) continue;
    std::pair<double, double> ends(std::numeric_limits<double>::max(), 0.0);
    for (const dvec3& value : key.values)
      ends = {std::min(ends.first, value.x), std::max(ends.second, value.x)};
    return ends;
  }
  return {otherwise, otherwise};
}

/// A sheet's Poisson's ratio is bounded by warp / weft, which keys change.
void check_sheets(const Scene& scene, const Reader& keys) {
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const auto* sheet = std::get_if<Fem>(&scene.cloths[i].material);
    if (!sheet) continue;
    const std::string material = "/cloths/" + std::to_string(i) + "/material/";
    const double warp = bounds(scene, material + "warp", sheet->warp).first,
                 weft = bounds(scene, material + "weft", sheet->weft).second;
    if (sheet->poisson * sheet->poisson < warp / weft) continue;
    for (std::size_t k = 0; k < scene.keys.size(); ++k)
      if (scene.keys[k].of == material + "warp" || scene.keys[k].of == material + "weft")
        return keys.element(k).member("at").fail(
            "the smallest warp over the largest weft is " + with_significant_digits(warp / weft, 3),
            "above " + with_significant_digits(sheet->poisson * sheet->poisson, 3) +
                ", the square of the material's poisson (or the sheet would gain energy by being stretched)");
  }
}

}  // namespace

void read_keys(const Reader& keys, Scene& scene) {
  const std::size_t count = keys.array(0, max_keys);
  std::vector<Keyed> places;
  for (std::size_t i = 0; i < count && !keys.failed(); ++i) {
    const Reader reader = keys.element(i);
    reader.object({"of", "at", "ease"});
    const Reader of = reader.member("of");
    Key key;
    key.of = of.string("a JSON Pointer");
    if (keys.failed()) return;
    Result<Keyed> place = keyed(scene, key.of);
    if (!place)
      return of.fail(compact(key.of) + (place.error().what.empty() ? "" : ": " + place.error().what),
                     place.error().remedy);
    const auto same = [&](const Keyed& earlier) { return earlier.overlaps(*place); };
    if (std::any_of(places.begin(), places.end(), same))
      return of.fail("a value that no earlier key sets: put its times into that one");
    places.push_back(*place);
    key.ease = read_ease(reader, *place);
    read_keyframes(reader.member("at"), *place, key);
    scene.keys.push_back(std::move(key));
  }
  if (!keys.failed()) check_sheets(scene, keys);
}

}  // namespace clothlab::scene
