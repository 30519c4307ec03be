// `clothlab info`: prints versions, methods, the folders of the data files, and all OpenGL devices with a
// mark at the default one.
#include <libwebsockets.h>

#include <iostream>
#include <memory>

#include "server/base/data_files.h"
#include "server/base/text.h"
#include "server/bus/bus.h"
#include "server/cli/commands.h"
#include "server/gl/context.h"
#include "server/scene/method.h"

namespace clothlab::cli {

namespace {

void print_data_folder(const std::string& what, const std::string& file) {
  const Result<std::filesystem::path> found = data_path(file);
  std::cout << what << (found ? found->parent_path().string() : "missing: " + found.error().text()) << "\n";
}

/// "24.6 GB of memory"
std::string memory_text(const gl::Device& device) {
  if (device.memory == 0) return "memory not told by the driver";
  return formatted("%.1f GB of memory", 1e-9 * static_cast<double>(device.memory));
}

void print_device(const gl::Device& device, bool used) {
  std::cout << (used ? "* " : "  ") << device.index << ": ";
  if (device.usable)
    std::cout << device.name << ", OpenGL " << device.version << (device.software ? " (software), " : ", ")
              << memory_text(device);
  else
    std::cout << "not usable: " << device.problem;
  if (!device.node.empty()) std::cout << ", " << device.node;
  std::cout << "\n";
}

int info() {
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
  if (!context) return fail(context.error(), exit_no_opengl);
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
