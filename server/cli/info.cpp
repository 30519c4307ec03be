// `clothlab info`: prints versions, methods, the folders of the data files, all OpenGL devices with a mark at
// the default one, and what is measured of that.
#include <libwebsockets.h>

#include <iostream>
#include <memory>

#include "server/base/data_files.h"
#include "server/base/text.h"
#include "server/bus/bus.h"
#include "server/cli/commands.h"
#include "server/gl/context.h"
#include "server/gl/gpus.h"
#include "server/gl/reads.h"
#include "server/scene/method.h"
#include "server/sim/sweep_form.h"

namespace clothlab::cli {

namespace {

void print_data_folder(const std::string& what, const std::string& file) {
  const Result<std::filesystem::path> found = data_path(file);
  std::cout << what << (found ? found->parent_path().string() : "missing: " + found.error().text()) << "\n";
}

/// "24.6 GB of memory"
std::string device_memory_text(const gl::Device& device) {
  if (device.memory == 0) return "memory not told by the driver";
  return formatted("%.1f GB of memory", 1e-9 * static_cast<double>(device.memory));
}

void print_device(const gl::Device& device, bool used) {
  std::cout << (used ? "* " : "  ") << device.index << ": ";
  if (device.usable)
    std::cout << device.name << ", OpenGL " << device.version << (device.software ? " (software), " : ", ")
              << device_memory_text(device);
  else
    std::cout << "not usable: " << device.problem;
  if (!device.node.empty()) std::cout << ", " << device.node;
  std::cout << "\n";
}

/// What is measured of the device that is used, once, and kept (gl/device_fact.h).
void print_measured() {
  const double storage = gl::storage_over_texture_reads();
  std::cout << formatted("     reads of storage buffers take %.2g times as long as of buffer textures: %s\n",
                         storage,
                         gl::fastest_reads() == gl::Reads::storage ? "storage buffers" : "buffer textures");
  for (const bool by_vertex : {false, true})
    std::cout << formatted(
        "     a small cloth under %s is swept by one work group up to %.0f vertices a colour\n",
        by_vertex ? "vbd" : "pbd and xpbd", sim::vertices_a_dispatch(by_vertex));
}

int info() {
  gl::compute_without_helper_threads();  // as small cloths do
  std::cout << "clothlab " CLOTHLAB_VERSION ", compiler " __VERSION__ ", libwebsockets "
            << lws_get_library_version() << "\n";
  const std::string bus = bus::library();
  std::cout << "bus      "
            << (bus.empty() ? "none: built without libnats, so no --publish and no relay" : bus) << "\n";
  std::cout << "methods ";
  for (const scene::Method method : scene::methods) std::cout << " " << scene::name(method);
  std::cout << "\n";
  print_data_folder("shaders  ", "shaders/access.glsl");
  print_data_folder("presets  ", "server/scene/presets/seed.json");
  print_data_folder("page     ", "web/dist/index.html");
  const Result<std::vector<gl::Device>> devices = gl::list_devices();
  if (!devices) return fail(devices.error(), exit_no_opengl);
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  std::cout << "devices" << (context ? " (* is used unless --gpu N says otherwise)\n" : "\n");
  for (const gl::Device& device : *devices)
    print_device(device, context && (*context)->device().index == device.index);
  for (const std::string& gpu : gl::gpus_without_opengl(*devices)) note(gpu);
  if (!context) return fail(context.error(), exit_no_opengl);
  print_measured();
  return exit_done;
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("info", "show versions, the OpenGL devices there are, and which one is used");
  command->footer("Exit code 3 if none of the devices is usable.");
  command->callback([&exit_code] { exit_code = info(); });
}

}  // namespace clothlab::cli
