// The curves and marks of a plot of error against cost.
#include <algorithm>
#include <map>

#include "server/lab/draw/points_layout.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

std::string path(const std::vector<Place>& places) {
  std::vector<std::pair<double, double>> corners;
  for (const Place& place : places) corners.emplace_back(place.x, place.y);
  return polyline_path(corners);
}

std::string title_of(const Layout& layout, std::size_t index) {
  const Point& point = layout.point(index);
  std::string title = text(point.setting);
  if (const std::optional<double> error = layout.plot->error(point)) title += ", error " + brief(*error, 2);
  if (point.cost) title += ", " + brief(point.cost->median) + " ms/s";
  if (point.dt_over_limit) title += ", " + brief(*point.dt_over_limit, 2) + " of the limit";
  return title;
}

std::string title_of(const Layout& layout, const Cross& cross) {
  const Point& point = layout.point(cross.index);
  std::string title = text(point.setting) + ": blew up at " + brief(*point.blew_up_at) + " s";
  if (point.dt_over_limit) title += ", " + brief(*point.dt_over_limit) + " times the stability limit";
  if (cross.cost)
    title += ", " + brief(*cross.cost) +
             (cross.inferred ? " ms/s, estimated from steps that did not blow up" : " ms/s");
  return title;
}

void draw_mark(Svg& svg, const Layout& layout, const Place& place, bool on_front) {
  const scene::Method method = layout.method(place.index);
  Attributes attributes{
      {"class", on_front ? "mark" : "mark beside"},
      {"data-index", std::to_string(place.index)},
      {"data-method", scene::name(method)},
      {"d", mark_path(mark_shape(method), place.x, place.y, on_front ? mark_radius : small_radius)},
      {"fill", colour(method)},
      {"stroke", paper},
      {"stroke-width", 0.8}};
  if (!on_front) attributes.push_back({"fill-opacity", "0.55"});
  svg.add("path", attributes, title_of(layout, place.index));
}

}  // namespace

void draw_curves(Svg& svg, const Layout& layout) {
  svg.open("g", {{"class", "curves"}, {"fill", "none"}, {"stroke-linejoin", "round"}});
  const std::vector<Place> best = front(layout.places);
  if (best.size() > 1)
    svg.add("path",
            {{"class", "front"},
             {"d", path(best)},
             {"stroke", "#ffd24d"},
             {"stroke-width", 13.0},
             {"stroke-opacity", "0.45"},
             {"stroke-linecap", "round"}},
            "the front of all methods: no measured setting is both cheaper and more accurate");
  for (const scene::Method method : scene::methods) {
    const std::vector<Place> own = of_method(layout, method);
    std::map<int, std::vector<Place>> alike;
    for (const Place& place : own)
      alike[iterates(method) ? layout.point(place.index).setting.iterations : 0].push_back(place);
    for (auto& [iterations, places] : alike) {
      std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
        return layout.point(a.index).setting.dt < layout.point(b.index).setting.dt;
      });
      if (places.size() > 1)
        svg.add("path", {{"class", "curve thin"},
                         {"data-method", scene::name(method)},
                         {"d", path(places)},
                         {"stroke", colour(method)},
                         {"stroke-width", 1.0},
                         {"stroke-opacity", "0.55"}});
    }
    const std::vector<Place> front_of_method = front(own);
    if (front_of_method.size() > 1)
      svg.add("path", {{"class", "curve"},
                       {"data-method", scene::name(method)},
                       {"d", path(front_of_method)},
                       {"stroke", colour(method)},
                       {"stroke-width", 2.4}});
  }
  svg.close();
}

void draw_marks(Svg& svg, const Layout& layout, Places& taken) {
  svg.open("g", {{"class", "marks"}});
  for (const scene::Method method : scene::methods) {
    const std::vector<Place> own = of_method(layout, method), best = front(own);
    for (const bool on_front : {false, true})  // marks of the method's front are drawn last, on top
      for (const Place& place : own) {
        const bool is = std::any_of(best.begin(), best.end(),
                                    [&](const Place& other) { return other.index == place.index; });
        if (is != on_front) continue;
        draw_mark(svg, layout, place, on_front);
        const double r = on_front ? mark_radius : small_radius;
        taken.take({place.x - r, place.y - r, place.x + r, place.y + r});
      }
  }
  svg.close();
}

void draw_crosses(Svg& svg, const Layout& layout) {
  if (layout.crosses.empty()) return;
  svg.open("g", {{"class", "blown-up"}});
  svg.add("rect", {{"class", "strip"},
                   {"x", layout.strip_left},
                   {"y", layout.y.to},
                   {"width", strip_width},
                   {"height", layout.y.from - layout.y.to},
                   {"fill", "#b03a2e"},
                   {"fill-opacity", "0.08"}});
  svg.text(layout.strip_left + strip_width / 2, layout.y.from + 18, "blew up", small_size, "middle",
           {{"class", "text"}, {"fill", ink}});
  for (const Cross& cross : layout.crosses) {
    const scene::Method method = layout.method(cross.index);
    svg.add("path",
            {{"class", "mark blown"},
             {"data-index", std::to_string(cross.index)},
             {"data-method", scene::name(method)},
             {"d", cross_path(layout.lane(cross.index), layout.height(cross), cross_radius)},
             {"fill", "none"},
             {"stroke", colour(method)},
             {"stroke-width", 2.0}},
            title_of(layout, cross));
  }
  svg.close();
}

}  // namespace clothlab::lab
