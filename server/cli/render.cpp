// `clothlab render S --time T --out F.png`: simulates up to a moment and draws it, without a window.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>

#include "server/cli/commands.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/render/renderer.h"

namespace clothlab::cli {

namespace {

struct RenderOptions {
  SceneChoice scene;
  double time = 0;  // [s]
  std::string out, size = "1280x720";
  std::optional<int> gpu;
};

struct Size {
  int width = 0, height = 0;  // [pixels]
};

Result<Size> parse_size(const std::string& text) {
  const Error malformed{"--size", text, "WIDTHxHEIGHT in pixels, e.g. 1280x720"};
  Size size;
  const char* end = text.data() + text.size();
  const std::from_chars_result width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return malformed;
  const std::from_chars_result height = std::from_chars(width.ptr + 1, end, size.height);
  if (height.ec != std::errc() || height.ptr != end) return malformed;
  if (Status allowed = render::check_size(size.width, size.height); !allowed)
    return Error{"--size", text, allowed.error().remedy};
  return size;
}

Result<Size> check_outputs(const RenderOptions& options) {
  Result<Size> size = parse_size(options.size);
  if (!size) return size;
  if (std::filesystem::path(options.out).extension() != ".png")
    return Error{"--out " + options.out, "unknown kind of file", "a file that ends in .png"};
  if (Status writable = check_writable("--out", options.out); !writable) return writable.error();
  return size;
}

Status draw(sim::Simulation& simulation, Size size, const std::string& path) {
  Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create();
  if (!renderer) return renderer.error();
  const std::vector<glm::vec3> positions = simulation.read_state().position;
  const std::vector<scene::Collider> colliders = simulation.colliders_now();
  const Result<render::Image> image = (*renderer)->render(
      {simulation.scene(), simulation.model(), positions, colliders}, size.width, size.height);
  if (!image) return image.error();
  const Result<std::vector<std::uint8_t>> png = render::encode_png(*image);
  if (!png) return png.error();
  return write_file(path, std::string(png->begin(), png->end()));
}

int render_scene(const RenderOptions& options) {
  const Result<Size> size = check_outputs(options);
  if (!size) return fail(size.error(), exit_usage);
  int exit_code = exit_done;
  const std::optional<Prepared> prepared = prepare(options.scene, options.gpu, exit_code);
  if (!prepared) return exit_code;
  sim::Simulation& simulation = *prepared->simulation;
  const double dt = simulation.scene().solver.dt;
  const Result<std::uint64_t> steps = whole_steps("--time", options.time, dt);
  if (!steps) return fail(steps.error(), exit_usage);
  const auto nothing_to_do = [](const sim::Diagnostics&) { return ok(); };
  const Result<Progress> progress =
      advance(*prepared, *steps, std::max<std::uint64_t>(*steps, 1), nothing_to_do);
  if (!progress) return fail(progress.error(), exit_internal);
  if (Status drawn = draw(simulation, *size, options.out); !drawn) return fail(drawn.error(), exit_internal);
  std::cout << options.out << ": " << options.size << ", " << simulation.scene().name << " at "
            << progress->state.time << " s\n";
  return exit_after(*progress);
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("render", "simulate up to a moment and draw it to a PNG, without a window");
  const auto options = std::make_shared<RenderOptions>();
  options->scene.add_positional(*command);
  command->add_option("--time", options->time, "the moment to draw [s]; rounded to whole steps")
      ->required()
      ->type_name("T");
  command->add_option("--out", options->out, "the picture (.png)")->required()->type_name("F");
  command->add_option("--size", options->size, "pixels")->type_name("WxH")->capture_default_str();
  add_gpu(*command, options->gpu);
  command->footer("Example:\n  clothlab render seed --time 1.5 --out seed.png --size 1920x1080");
  command->callback([options, &exit_code] { exit_code = render_scene(*options); });
}

}  // namespace clothlab::cli
