#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/base/priority.h"
#include "server/gl/context.h"
#include "server/gl/software/displays.h"

namespace clothlab::gl {

namespace {

/// Where one thread and two are even, within the noise of a machine of two cores.
constexpr std::size_t most_vertices_of_one_thread = 32 * 32;

void make_once(std::once_flag& made, int nice, std::optional<int> gpu, HelperThreads threads) {
  std::call_once(made, [&] {
    software::check_software("helper threads");
    std::thread([&] {
      lower_priority(nice);
      (void)Context::create(gpu, threads);
    }).join();
  });
}

/// The processor is the device where OpenGL is software: its name there does not tell it.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line;
  return {};
}

}  // namespace

void make_helper_threads(std::optional<int> gpu, HelperThreads threads) {
  static std::once_flag of_sessions, of_lab;
  if (!software_device(gpu)) return;
  if (threads == HelperThreads::sessions) make_once(of_sessions, 5, gpu, threads);
  if (threads == HelperThreads::lab) make_once(of_lab, 19, gpu, threads);
}

bool needs_no_helper_threads(std::size_t vertices) {
  return vertices <= most_vertices_of_one_thread;
}

std::string what_computes() {
  software::check_software("its processor");
  return (computes_on_calling_thread() ? "one thread, " : "helper threads, ") + processor();
}

}  // namespace clothlab::gl
