// The lab's pictures, one for each kind of result, and what they share: the methods' colours and shapes, the
// heading, the axes, and the notes below. Private to exports.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/draw/plot.h"
#include "server/lab/job.h"
#include "server/scene/method.h"

namespace clothlab::lab {

std::string draw(const Chart& chart, Axis axis);
std::string draw(const Choice& choice, Axis axis);
std::string draw(const StabilityMap& map);
std::string draw(const Simplification& simplification);

inline constexpr double picture_width = 720, margin = 16;
inline constexpr double title_size = 18, text_size = 14, small_size = 13;  ///< font sizes [view box]
inline constexpr const char *ink = "#222222", *soft_ink = "#555555", *paper = "#ffffff";

/// A method's colour, the same in every picture. Colour-blind readers can tell the colours apart too (Okabe
/// and Ito 2008), on a white page and on a dark one.
const char* colour(scene::Method method);
/// The shape of a method's mark, for mark_path.
std::size_t mark_shape(scene::Method method);

/// Writes the title on one line and, below it, `lines`, each wrapped to at most two. Returns y of the next
/// line of text.
double write_heading(Svg& svg, const std::string& title, const std::vector<std::string>& lines);
/// Writes notes below a picture, from `y` on, in at most `most_lines` lines per paragraph. Returns y of the
/// next line of text.
double write_notes(Svg& svg, double y, const std::vector<std::string>& paragraphs, std::size_t most_lines);
/// The number of lines that write_notes would write.
std::size_t note_lines(const std::vector<std::string>& paragraphs, std::size_t most_lines);
/// Writes words with an outline in the paper's colour, so that they are readable over a curve.
void write_over(Svg& svg, double x, double y, const std::string& words, double font_size, const char* anchor,
                const Attributes& attributes);
/// "scene seed, on llvmpipe (LLVM 15.0.6, 256 bits)".
std::string scene_and_renderer(const std::string& scene, const std::string& renderer);

/// Attributes from which a page computes places in a plot: the range of values, and its place in the view
/// box.
Attributes scale_attributes(const Scale& x, const Scale& y);
/// Attributes that say where the picture lies between heading and notes, for a page that writes those itself.
Attributes body_attributes(double top, double bottom);
/// Draws grid lines, tick labels, axis labels and the frame of a plot. `x_label` may take two lines.
void draw_axes(Svg& svg, const Scale& x, const Scale& y, const std::string& x_label,
               const std::string& y_label);

/// A plot of settings as points of error against cost. The chart and the choice are both drawn this way.
struct PointsPlot {
  struct Line {
    double value = 0;   ///< the error at which the line stands
    std::string words;  ///< the line's name
    const char* kind = "";
    const char* colour = soft_ink;
  };
  struct Ring {
    std::size_t index = 0;  ///< in `points`
    std::string words;      ///< e.g. "runner-up"
    const char* kind = "";
  };
  std::string title;
  std::vector<std::string> heading;
  std::string x_label;
  std::string empty;  ///< text of a plot in which no point has an error
  const std::vector<Point>* points = nullptr;
  std::function<std::optional<double>(const Point&)> error;
  std::vector<Line> lines;
  std::vector<Ring> rings;
  std::vector<std::string> notes;
};
std::string draw(const PointsPlot& plot);

/// The index of the point that was measured with `setting`, if there is one.
std::optional<std::size_t> index_of(const std::vector<Point>& points, const Setting& setting);

}  // namespace clothlab::lab
