// The lab's pictures, one a kind of result, and what they share: the methods' colours and shapes, the paper,
// the words below. Private to exports.
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
inline constexpr double title_size = 18, text_size = 14, small_size = 13;  ///< of the font, in the view box
inline constexpr const char *ink = "#222222", *soft_ink = "#555555", *paper = "#ffffff";

/// A method's colour, the same in every picture. They differ for the colour-blind too (Okabe and Ito 2008),
/// and on white as on a dark page.
const char* colour(scene::Method method);
/// Its mark: see mark_path.
std::size_t shape(scene::Method method);

/// Title, what it is of, and what it ran on. Returns where the next line of text would stand.
double write_heading(Svg& svg, const std::string& title, const std::vector<std::string>& lines);
/// Words below a picture, `most_lines` at most a paragraph; returns where the next one would stand.
double write_notes(Svg& svg, double y, const std::vector<std::string>& paragraphs, std::size_t most_lines);
/// Lines that write_notes would need.
std::size_t note_lines(const std::vector<std::string>& paragraphs, std::size_t most_lines);
/// Words that stay readable over a curve.
void write_over(Svg& svg, double x, double y, const std::string& words, double font_size, const char* anchor,
                const Attributes& attributes);
/// "seed on llvmpipe (LLVM 15.0.6, 256 bits)".
std::string scene_and_renderer(const std::string& scene, const std::string& renderer);

/// The root's attributes that let a page place things: ranges of values, and where they are.
Attributes scale_attributes(const Scale& x, const Scale& y);
/// The part of the view box between heading and notes, for a page that says these itself.
Attributes body_attributes(double top, double bottom);
/// Grid lines, ticks' labels and the frame of a plot. `x_label` may take two lines.
void draw_axes(Svg& svg, const Scale& x, const Scale& y, const std::string& x_label,
               const std::string& y_label);

/// Settings as points of error against cost: what the chart and the choice have in common.
struct PointsPlot {
  struct Line {
    double value = 0;   ///< of the error
    std::string words;  ///< short
    const char* kind = "";
    const char* colour = soft_ink;
  };
  struct Ring {
    std::size_t index = 0;  ///< of the point
    std::string words;      ///< "chosen"
    const char* kind = "";
  };
  std::string title;
  std::vector<std::string> heading;
  std::string x_label;
  std::string empty;  ///< what to say where there is no point with an error
  const std::vector<Point>* points = nullptr;
  std::function<std::optional<double>(const Point&)> error;
  std::vector<Line> lines;
  std::vector<Ring> rings;
  std::vector<std::string> notes;
};
std::string draw(const PointsPlot& plot);

/// Where among the points `setting` is, if it was measured.
std::optional<std::size_t> index_of(const std::vector<Point>& points, const Setting& setting);

}  // namespace clothlab::lab
