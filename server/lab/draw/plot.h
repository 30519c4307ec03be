// The building blocks of the lab's pictures: an SVG written element by element, axes with round ticks, the
// width of words, and a record of the places that are taken. Nothing here knows about cloth. The SVG has
// presentation attributes instead of styles and scripts, and classes by which a page can change its colours.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace clothlab::lab {

/// "0.76", "1.2e-3": at most `digits` significant digits, no zeros before the exponent. Not finite: "-".
std::string brief(double value, int digits = 3);
/// "2 points", "1 point". `many`: the plural, if it is not `one` with an "s".
std::string count(std::size_t number, const std::string& one, const std::string& many = "");
/// `text` with &, <, > and " as entities, and without the control characters that XML forbids.
std::string escaped(const std::string& text);

/// The approximate width of words in the widest of the usual sans-serif fonts [view box].
double text_width(const std::string& text, double font_size);
/// `text` in lines of at most `width` [view box]. Text that needs more than `most` lines ends in an ellipsis.
std::vector<std::string> wrapped(const std::string& text, double width, double font_size, std::size_t most);

struct Attribute {
  const char* name;
  std::string value;
  Attribute(const char* of, std::string text) : name(of), value(std::move(text)) {}
  Attribute(const char* of, const char* text) : name(of), value(text) {}
  Attribute(const char* of, double number);
};
using Attributes = std::vector<Attribute>;

class Svg {
 public:
  /// `label` is what a screen reader says; `root` holds further attributes of the root element.
  Svg(double width, double height, const std::string& label, const Attributes& root);

  void open(const char* element, const Attributes& attributes, const std::string& title = "");
  void close();
  /// Writes an element without children. A viewer shows `title` while the pointer is on the element.
  void add(const char* element, const Attributes& attributes, const std::string& title = "");
  /// anchor: "start", "middle" or "end".
  void text(double x, double y, const std::string& words, double font_size, const char* anchor,
            Attributes attributes = {});
  void line(double x1, double y1, double x2, double y2, Attributes attributes);
  std::string finish();

 private:
  void write(const char* element, const Attributes& attributes);
  std::string out_;
  std::vector<const char*> open_;
};

/// Maps values to places along one axis of the view box.
struct Scale {
  double low = 0, high = 1;  ///< range of values: low < high, both above 0 if `log`
  double from = 0, to = 1;   ///< places of `low` and `high` [view box]
  bool log = true;
  /// The place of a value; a value beyond the range is placed on its edge.
  double operator()(double value) const;
};

/// A logarithmic scale from `least` to `most` with some room on both sides; its high over its low is at least
/// `least_ratio`. If the two are not finite positive numbers in order, the scale is from 0.1 to 10.
Scale log_scale(double least, double most, double from, double to, double least_ratio = 4);

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a minor tick
};
/// Ticks within the range, about `most` of them labelled. Labels on a logarithmic scale: powers of ten, in a
/// short range also 2 and 5 times these; on a linear scale: round numbers.
std::vector<Tick> ticks(const Scale& scale, int most = 8);

struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool holds(const Box& other) const {
    return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
  }
};

/// Records which places of a picture are taken, and finds free ones for words.
class Places {
 public:
  explicit Places(const Box& all) : all_(all) {}
  void take(const Box& box) { taken_.push_back(box); }
  bool is_free(const Box& box) const;
  /// Finds and takes a free place for words beside a mark of `radius` at (x, y): right, left, or diagonally
  /// above or below; none if all are taken. The words start at the box's left and stand on its bottom.
  std::optional<Box> beside(double x, double y, double radius, const std::string& words, double font_size);

 private:
  Box all_;
  std::vector<Box> taken_;
};

/// The path of a mark, in one of eight shapes that differ even without colour. `shape` is taken modulo 8.
std::string mark_path(std::size_t shape, double x, double y, double radius);
/// The path of a cross, to be stroked.
std::string cross_path(double x, double y, double radius);
/// The path "Mx yLx y..." through `places`.
std::string polyline_path(const std::vector<std::pair<double, double>>& places);

}  // namespace clothlab::lab
