#include "server/sweep/quiet.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace clothlab::sweep {

namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Processor time that the cores of `usable` have worked since the machine started [s], from /proc/stat.
std::optional<double> busy_seconds(const cpu_set_t& usable) {
  std::ifstream file("/proc/stat");
  double ticks = 0;
  bool any = false;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string core;
    words >> core;
    if (!core.starts_with("cpu") || core.size() == 3) continue;  // the first line is the sum
    if (!CPU_ISSET(std::stoul(core.substr(3)), &usable)) continue;
    any = true;
    // user, nice, system, idle, iowait, irq, softirq, steal
    double value = 0;
    for (int i = 0; i < 8 && words >> value; ++i)
      if (i != 3 && i != 4) ticks += value;
  }
  if (!any) return std::nullopt;
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

Quiet::Reading Quiet::read() {
  Reading reading;
  cpu_set_t usable;
  CPU_ZERO(&usable);
  if (sched_getaffinity(0, sizeof usable, &usable) == 0) reading.busy = busy_seconds(usable);
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  reading.own = seconds(used.ru_utime) + seconds(used.ru_stime);
  reading.at = std::chrono::steady_clock::now();
  return reading;
}

Quiet::Quiet() : start_(read()) {}

std::optional<double> Quiet::others() const {
  const Reading now = read();
  const double elapsed = std::chrono::duration<double>(now.at - start_.at).count();
  if (!now.busy || !start_.busy || elapsed <= 0) return std::nullopt;
  // /proc/stat counts in ticks of 10 ms, so that the work of a core may seem one tick more at each end.
  const double ticks = 2.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
  return std::max(0.0, (*now.busy - *start_.busy - (now.own - start_.own) - ticks) / elapsed);
}

}  // namespace clothlab::sweep
