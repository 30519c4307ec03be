// What a picture of the lab is made of: an SVG written element by element, axes with sensible ticks, how much
// room words take, and which places are taken. Knows nothing of cloth. No styles and no scripts: presentation
// attributes, and classes for whoever wants to colour it otherwise.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace clothlab::lab {

/// "0.76", "1.2e-3": three digits at most, without the zeros of %g's exponents. Not finite: "-".
std::string brief(double value, int digits = 3);
/// "2 points", "1 point".
std::string count(std::size_t number, const std::string& one, const std::string& many = "");
/// `text` with &, <, > and quotes as entities, and what XML does not allow left out.
std::string escaped(const std::string& text);

/// About how wide words are in the widest of the usual sans-serif fonts [units of the view box].
double text_width(const std::string& text, double font_size);
/// Lines of at most `width`; what does not fit into `most` lines ends in an ellipsis.
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
  /// `label`: what a screen reader says of it. `root` goes to the root element.
  Svg(double width, double height, const std::string& label, const Attributes& root);

  void open(const char* element, const Attributes& attributes, const std::string& title = "");
  void close();
  /// An element of its own; `title` is what a viewer shows while the pointer is on it.
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

/// Values to places; `from` and `to` are in the view box.
struct Scale {
  double low = 0, high = 1;  ///< values, low < high; above 0 where `log`
  double from = 0, to = 1;   ///< where `low` and `high` are
  bool log = true;
  /// Where a value is; those beyond the range on its edge.
  double operator()(double value) const;
};

/// A logarithmic range that holds the values from least to most with some room on both sides, and at least a
/// factor of `least_ratio`. Any range where they are no positive numbers.
Scale log_scale(double least, double most, double from, double to, double least_ratio = 4);

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a minor one
};
/// Ticks within the range, about `most` of them labelled: powers of ten (and 2 and 5 times these where the
/// range is short), or round numbers of a linear one.
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

/// Which places of a picture are taken.
class Places {
 public:
  explicit Places(const Box& all) : all_(all) {}
  void take(const Box& box) { taken_.push_back(box); }
  bool is_free(const Box& box) const;
  /// The place for words beside a mark of `radius` at x, y (right, left, above, below), taken; none where all
  /// are occupied. x of the answer is where the words start, its bottom where they stand.
  std::optional<Box> beside(double x, double y, double radius, const std::string& words, double font_size);

 private:
  Box all_;
  std::vector<Box> taken_;
};

/// The path of a mark: eight shapes that can be told apart without their colour. `shape` is taken modulo 8.
std::string mark_path(std::size_t shape, double x, double y, double radius);
/// A cross, as a path to be stroked.
std::string cross_path(double x, double y, double radius);
/// "M x y L x y ..."
std::string polyline_path(const std::vector<std::pair<double, double>>& places);

}  // namespace clothlab::lab
