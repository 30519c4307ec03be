#include "server/gl/gpus.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace clothlab::gl {

namespace {

namespace fs = std::filesystem;

/// A file as this process sees it, and what it is called.
struct Place {
  fs::path path;
  std::string name;
};

Place place(const std::string& name) {
  const char* folder = std::getenv("CLOTHLAB_GPU_FILES");
  return {(folder ? std::string(folder) : "") + name, name};
}

/// The entries of a folder whose names begin so, sorted.
std::vector<Place> entries(const std::string& folder, std::string_view begins) {
  std::vector<Place> found;
  std::error_code failure;
  for (fs::directory_iterator entry(place(folder).path, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(begins)) found.push_back({entry->path(), folder + "/" + name});
  }
  std::sort(found.begin(), found.end(), [](const Place& a, const Place& b) { return a.name < b.name; });
  return found;
}

std::string first_word(const fs::path& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

struct Maker {
  const char* name;
  const char* vendor;  ///< of PCI
};
constexpr std::array makers{Maker{"NVIDIA", "0x10de"}, Maker{"AMD", "0x1002"}, Maker{"Intel", "0x8086"}};

/// A display controller of this maker among the machine's PCI devices, which a container sees, too.
std::optional<std::string> on_bus(const Maker& maker) {
  for (const Place& device : entries("/sys/bus/pci/devices", ""))
    if (first_word(device.path / "vendor") == maker.vendor &&
        first_word(device.path / "class").starts_with("0x03"))
      return "PCI " + fs::path(device.name).filename().string();
  return std::nullopt;
}

/// The render node of a maker's GPU that is passed to this process.
std::optional<Place> render_node(const Maker& maker) {
  for (const Place& node : entries("/dev/dri", "renderD")) {
    const std::string about = "/sys/class/drm/" + fs::path(node.name).filename().string() + "/device/vendor";
    if (first_word(place(about).path) == maker.vendor) return node;
  }
  return std::nullopt;
}

bool offers(const std::vector<Device>& listed, bool nvidia) {
  return std::any_of(listed.begin(), listed.end(), [&](const Device& device) {
    return device.usable && !device.software && (device.vendor.find("NVIDIA") != std::string::npos) == nvidia;
  });
}

/// `other`: OpenGL offers a GPU by Mesa, which may be this one.
std::optional<std::string> nvidia_without_opengl(bool other) {
  const Maker& nvidia = makers[0];
  std::error_code failure;
  for (const char* file : {"/dev/nvidia0", "/dev/nvidiactl"})
    if (fs::exists(place(file).path, failure))
      return std::string("an NVIDIA GPU is here (") + file +
             ") without its OpenGL: to a container pass --gpus all -e "
             "NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility, and have libegl1 in it; on the machine "
             "itself install libegl1 and the driver's OpenGL (Debian: libegl1 libegl-nvidia0; Ubuntu: "
             "libegl1 libnvidia-gl-VERSION)";
  const std::optional<std::string> bus = on_bus(nvidia);
  if (!bus || other) return std::nullopt;
  return "an NVIDIA GPU is in this machine (" + *bus +
         ") and not passed on, or without its driver (no /dev/nvidia0): to a container pass --gpus all -e "
         "NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility (on the host: nvidia-container-toolkit); on "
         "the machine itself install NVIDIA's driver";
}

std::optional<std::string> other_without_opengl(const Maker& maker) {
  const std::string a = maker.name[0] == 'A' || maker.name[0] == 'I' ? "an " : "a ";
  if (const std::optional<Place> node = render_node(maker)) {
    if (access(node->path.c_str(), R_OK | W_OK) != 0)
      return a + maker.name + " GPU is here (" + node->name +
             ") and this user may not open it: to a container pass --group-add with the number of the "
             "host's group render (getent group render); on the machine itself, adduser USER render";
    return a + maker.name + " GPU is here (" + node->name +
           ") without its OpenGL: install Mesa's drivers, apt-get install libegl1 libegl-mesa0 "
           "libgl1-mesa-dri";
  }
  const std::optional<std::string> bus = on_bus(maker);
  if (!bus) return std::nullopt;
  return a + maker.name + " GPU is in this machine (" + *bus +
         ") and not passed on, or without its kernel driver (no /dev/dri/renderD128): to a container pass "
         "--device /dev/dri --group-add with the number of the host's group render";
}

}  // namespace

std::vector<std::string> gpus_without_opengl(const std::vector<Device>& listed) {
  std::vector<std::string> found;
  const auto add = [&](std::optional<std::string> told) {
    if (told) found.push_back(std::move(*told));
  };
  const bool by_mesa = offers(listed, false);
  if (!offers(listed, true)) add(nvidia_without_opengl(by_mesa));
  if (!by_mesa)
    for (const Maker& maker : {makers[1], makers[2]}) add(other_without_opengl(maker));
  return found;
}

}  // namespace clothlab::gl
