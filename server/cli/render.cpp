// `clothlab render S --time T --out F.png`: simulates up to a moment and draws it, without a window.
#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>
#include <utility>

#include "server/cli/camera_option.h"
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
  std::optional<std::string> camera;
  bool clear = false;
  std::optional<int> gpu;
};

struct Size {
  int width = 0, height = 0;  // [pixels]
};

constexpr std::array<std::pair<const char*, Size>, 3> named_sizes{
    {{"1080p", {1920, 1080}}, {"4K", {3840, 2160}}, {"square", {1080, 1080}}}};

Result<Size> parse_size(const std::string& text) {
  for (const auto& [name, size] : named_sizes)
    if (text == name) return size;
  const Error malformed{"--size", text, "WIDTHxHEIGHT in pixels, e.g. 1280x720, or 1080p, 4K or square"};
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

Status draw(sim::Simulation& simulation, Size size, const CameraChoice& camera,
            const RenderOptions& options) {
  Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create();
  if (!renderer) return renderer.error();
  const std::vector<glm::vec3> positions = simulation.read_state().position;
  const std::vector<scene::Collider> colliders = simulation.colliders_now();
  const render::DrawnMoment moment{simulation.scene(), simulation.model(), positions,    colliders,
                                   camera.subject,     camera.view,        options.clear};
  const Result<render::Image> image = (*renderer)->render(moment, size.width, size.height);
  if (!image) return image.error();
  const Result<std::vector<std::uint8_t>> png = render::encode_png(*image);
  if (!png) return png.error();
  return write_file(options.out, std::string(png->begin(), png->end()));
}

int render_scene(const RenderOptions& options) {
  const Result<Size> size = check_outputs(options);
  if (!size) return fail(size.error(), exit_usage);
  const Result<CameraChoice> camera =
      options.camera ? parse_camera(*options.camera) : Result<CameraChoice>(CameraChoice{});
  if (!camera) return fail(camera.error(), exit_usage);
  int exit_code = exit_done;
  const std::optional<Prepared> prepared = prepare(options.scene, options.gpu, exit_code);
  if (!prepared) return exit_code;
  sim::Simulation& simulation = *prepared->simulation;
  if (Status there = check_subject(*camera, simulation.scene()); !there)
    return fail(there.error(), exit_usage);
  const double dt = simulation.scene().solver.dt;
  const Result<std::uint64_t> steps = whole_steps("--time", options.time, dt);
  if (!steps) return fail(steps.error(), exit_usage);
  const auto nothing_to_do = [](const sim::Diagnostics&) { return ok(); };
  const Result<Progress> progress =
      advance(*prepared, *steps, std::max<std::uint64_t>(*steps, 1), nothing_to_do);
  if (!progress) return fail(progress.error(), exit_internal);
  if (Status drawn = draw(simulation, *size, *camera, options); !drawn)
    return fail(drawn.error(), exit_internal);
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
  command->add_option("--size", options->size, "pixels, or 1080p, 4K, square")
      ->type_name("WxH")
      ->capture_default_str();
  add_camera(*command, options->camera);
  command->add_flag("--clear", options->clear,
                    "without background: transparent beside the scene; a plane is only the shadow on it");
  add_gpu(*command, options->gpu);
  command->footer(
      "Example:\n  clothlab render seed --time 1.5 --out seed.png --size 1080p\n"
      "  clothlab render drape --time 1 --out ball.png --camera \"ball;from=2,1,2\"");
  command->callback([options, &exit_code] { exit_code = render_scene(*options); });
}

}  // namespace clothlab::cli
