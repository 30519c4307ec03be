// A picture of a cloth over solids, by the mean colours of its cells.
#include <algorithm>
#include <cmath>

#include "server/render/renderer.h"
#include "server/selftest/checks.h"

namespace clothlab::selftest {

namespace {

constexpr int columns = 16, rows = 9, cell = 20;  // [pixels]
/// Devices differ at edges, where they take other samples of a pixel: an edge goes through up to 28 of a
/// cell's 400 pixels, and 4 samples tell its share to an eighth, of a contrast of up to 255.
constexpr double allowed_difference = 28.0 / (cell * cell) * 255.0 / 8.0;

}  // namespace

Result<std::vector<double>> colours_of(const ShortRun& run) {
  const Result<model::Model> model = model::build(run.scene);
  if (!model) return model.error();
  const Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create();
  if (!renderer) return renderer.error();
  // At the start: whatever is wrong with steps is told by others.
  const std::vector<glm::vec3> positions(model->start_position.begin(), model->start_position.end());
  const Result<render::Image> image =
      (*renderer)->render({run.scene, *model, positions, run.scene.colliders}, columns * cell, rows * cell);
  if (!image) return image.error();
  std::vector<double> colours(columns * rows * 3, 0.0);
  for (std::size_t y = 0; y < rows * cell; ++y)
    for (std::size_t x = 0; x < columns * cell; ++x)
      for (std::size_t part = 0; part < 3; ++part)
        colours[3 * (y / cell * columns + x / cell) + part] +=
            image->pixels[3 * (y * columns * cell + x) + part] / static_cast<double>(cell * cell);
  return colours;
}

Result<Check> check_picture(const ShortRun& run) {
  const Result<std::vector<double>> kept = read_colours(colours_file), drawn = colours_of(run);
  if (!kept) return kept.error();
  if (!drawn) return drawn.error();
  double off = kept->size() == drawn->size() ? 0.0 : 255.0;
  for (std::size_t i = 0; i < std::min(kept->size(), drawn->size()); ++i)
    off = std::max(off, std::abs((*kept)[i] - (*drawn)[i]));
  return at_most("picture", off, allowed_difference, "of 255", "off is a part of a picture");
}

}  // namespace clothlab::selftest
