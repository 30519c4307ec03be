#include "server/lab/draw/plot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/base/text.h"

namespace clothlab::lab {

namespace {

/// A coordinate in the view box as text, rounded to 0.01, which is less than a screen shows.
std::string place(double value) {
  std::string text = formatted("%.2f", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

/// 10^exponent as people write it: "100", "0.1", "10⁻³".
std::string power_of_ten(int exponent) {
  if (exponent >= 0 && exponent <= 4) return std::string("1").append(static_cast<std::size_t>(exponent), '0');
  if (exponent == -1) return "0.1";
  static const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = "10";
  if (exponent < 0) text += "⁻";
  for (const char digit : std::to_string(std::abs(exponent))) text += digits[digit - '0'];
  return text;
}

std::vector<Tick> log_ticks(const Scale& scale, int most) {
  std::vector<Tick> ticks;
  const int first = static_cast<int>(std::floor(std::log10(scale.low) + 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(scale.high) - 1e-9));
  const int decades = last - first;
  const int every = std::max(1, (decades + most - 1) / most);
  const bool few = std::log10(scale.high / scale.low) < 2.2;
  for (int exponent = first; exponent <= last; ++exponent)
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10.0, exponent);
      if (value < scale.low * (1 - 1e-9) || value > scale.high * (1 + 1e-9)) continue;
      if (digit > 1 && decades > 10) continue;
      std::string label;
      if (digit == 1 && exponent % every == 0)
        label = power_of_ten(exponent);
      else if (few && (digit == 2 || digit == 5))
        label = exponent >= -3 && exponent <= 4 ? brief(value, 1)
                                                : std::to_string(digit) + "·" + power_of_ten(exponent);
      ticks.push_back({value, label});
    }
  return ticks;
}

std::vector<Tick> linear_ticks(const Scale& scale, int most) {
  const double raw = (scale.high - scale.low) / std::max(most, 1);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double round : {5.0, 2.0, 1.0})
    if (round * power >= raw) step = round * power;
  std::vector<Tick> ticks;
  for (double at = std::ceil(scale.low / step - 1e-9); at * step <= scale.high + 1e-9 * step; ++at)
    ticks.push_back({at * step, brief(at == 0 ? 0.0 : at * step, 4)});
  return ticks;
}

std::string corners(double x, double y, double radius, int count, double turn, double inner = 1) {
  std::vector<std::pair<double, double>> places;
  for (int corner = 0; corner < count; ++corner) {
    const double angle = 2 * std::numbers::pi * corner / count + turn;
    const double r = corner % 2 == 0 ? radius : radius * inner;
    places.emplace_back(x + r * std::cos(angle), y + r * std::sin(angle));
  }
  return polyline_path(places) + "Z";
}

std::string circle(double x, double y, double radius) {
  const std::string r = place(radius), d = place(2 * radius);
  std::string path = "M";
  path.append(place(x - radius)).append(" ").append(place(y));
  for (const char* side : {" 0 1 0 ", " 0 1 0 -"})
    path.append("a").append(r).append(" ").append(r).append(side).append(d).append(" 0");
  return path.append("Z");
}

}  // namespace

Attribute::Attribute(const char* of, double number) : name(of), value(place(number)) {}

Svg::Svg(double width, double height, const std::string& label, const Attributes& root) {
  Attributes all{{"xmlns", "http://www.w3.org/2000/svg"},
                 {"viewBox", "0 0 " + place(width) + " " + place(height)},
                 {"width", width},
                 {"height", height},
                 {"role", "img"},
                 {"aria-label", label},
                 {"font-family", "Helvetica, Arial, sans-serif"}};
  all.insert(all.end(), root.begin(), root.end());
  open("svg", all);
  add("rect", {{"class", "paper background"}, {"width", width}, {"height", height}, {"fill", "#ffffff"}});
}

void Svg::write(const char* element, const Attributes& attributes) {
  out_ += std::string("<") + element;
  for (const Attribute& attribute : attributes)
    out_ += std::string(" ") + attribute.name + "=\"" + escaped(attribute.value) + "\"";
}

void Svg::open(const char* element, const Attributes& attributes, const std::string& title) {
  write(element, attributes);
  out_ += ">";
  if (!title.empty()) out_ += "<title>" + escaped(title) + "</title>";
  out_ += "\n";
  open_.push_back(element);
}

void Svg::close() {
  out_ += std::string("</") + open_.back() + ">\n";
  open_.pop_back();
}

void Svg::add(const char* element, const Attributes& attributes, const std::string& title) {
  write(element, attributes);
  out_ += title.empty() ? "/>\n" : "><title>" + escaped(title) + "</title></" + element + ">\n";
}

void Svg::text(double x, double y, const std::string& words, double font_size, const char* anchor,
               Attributes attributes) {
  attributes.insert(attributes.begin(),
                    {{"x", x}, {"y", y}, {"font-size", font_size}, {"text-anchor", anchor}});
  write("text", attributes);
  out_.append(">").append(escaped(words)).append("</text>\n");
}

void Svg::line(double x1, double y1, double x2, double y2, Attributes attributes) {
  attributes.insert(attributes.begin(), {{"x1", x1}, {"y1", y1}, {"x2", x2}, {"y2", y2}});
  add("line", attributes);
}

std::string Svg::finish() {
  while (!open_.empty()) close();
  return out_;
}

double Scale::operator()(double value) const {
  // NaN is placed at `high`: a mark on the edge is better than no mark.
  const double within = std::isnan(value) ? high : std::clamp(value, low, high);
  const double share = log ? std::log(within / low) / std::log(high / low) : (within - low) / (high - low);
  return from + share * (to - from);
}

Scale log_scale(double least, double most, double from, double to, double least_ratio) {
  if (!(least > 0) || !(most >= least) || !std::isfinite(most)) return {0.1, 10, from, to, true};
  const double short_of = std::max(least_ratio / (most / least), 1.0);
  const double room = std::pow(most / least, 0.04) * std::sqrt(short_of);
  return {least / room, most * room, from, to, true};
}

std::vector<Tick> ticks(const Scale& scale, int most) {
  return scale.log ? log_ticks(scale, most) : linear_ticks(scale, most);
}

bool Places::is_free(const Box& box) const {
  return all_.holds(box) &&
         std::none_of(taken_.begin(), taken_.end(), [&](const Box& taken) { return taken.meets(box); });
}

std::optional<Box> Places::beside(double x, double y, double radius, const std::string& words,
                                  double font_size) {
  const double width = text_width(words, font_size), height = font_size, gap = radius + 3;
  const double middle = y - height / 2;
  for (const auto& [left, top] :
       {std::pair{x + gap, middle}, std::pair{x - gap - width, middle}, std::pair{x + gap, y - gap - height},
        std::pair{x - gap - width, y + gap}, std::pair{x + gap, y + gap},
        std::pair{x - gap - width, y - gap - height}}) {
    const Box box{left, top, left + width, top + height};
    if (!is_free(box)) continue;
    take(box);
    return box;
  }
  return std::nullopt;
}

std::string polyline_path(const std::vector<std::pair<double, double>>& places) {
  std::string path;
  for (const auto& [x, y] : places)
    path.append(path.empty() ? "M" : "L").append(place(x)).append(" ").append(place(y));
  return path;
}

std::string mark_path(std::size_t shape, double x, double y, double radius) {
  constexpr double pi = std::numbers::pi;
  const double r = radius, thick = 0.42 * radius;
  switch (shape % 8) {
    case 0:
      return corners(x, y + 0.15 * r, 1.2 * r, 3, pi / 2);  // a triangle on its tip
    case 1:
      return circle(x, y, r);
    case 2:
      return corners(x, y, 1.25 * r, 4, pi / 4);  // a square
    case 3:
      return corners(x, y, 1.3 * r, 4, 0);  // a square on its corner
    case 4:
      return corners(x, y + 0.15 * r, 1.2 * r, 3, -pi / 2);
    case 5:  // a plus
      return polyline_path({{x - thick, y - 1.2 * r},
                            {x + thick, y - 1.2 * r},
                            {x + thick, y - thick},
                            {x + 1.2 * r, y - thick},
                            {x + 1.2 * r, y + thick},
                            {x + thick, y + thick},
                            {x + thick, y + 1.2 * r},
                            {x - thick, y + 1.2 * r},
                            {x - thick, y + thick},
                            {x - 1.2 * r, y + thick},
                            {x - 1.2 * r, y - thick},
                            {x - thick, y - thick}}) +
             "Z";
    case 6:
      return corners(x, y, 1.35 * r, 10, -pi / 2, 0.45);  // a star
    default:                                              // an hourglass
      return polyline_path({{x - r, y - r}, {x + r, y - r}, {x - r, y + r}, {x + r, y + r}}) + "Z";
  }
}

std::string cross_path(double x, double y, double radius) {
  return polyline_path({{x - radius, y - radius}, {x + radius, y + radius}}) +
         polyline_path({{x - radius, y + radius}, {x + radius, y - radius}});
}

}  // namespace clothlab::lab
