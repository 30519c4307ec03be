#include "server/net/metrics.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "server/base/text.h"

namespace clothlab::net {

namespace {

void head(std::string& out, const std::string& name, const char* type, const char* help) {
  out += "# HELP " + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
}

void family(std::string& out, const std::string& name, const char* type, const char* help,
            const std::string& value) {
  head(out, name, type, help);
  out += name + " " + value + "\n";
}

/// What this process uses, as Linux tells it.
struct Usage {
  double cpu_seconds = 0;
  std::uint64_t resident_bytes = 0, open_files = 0;
};

Usage usage_now() {
  Usage usage;
  timespec cpu{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu) == 0)
    usage.cpu_seconds = static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec);
  std::uint64_t pages = 0, resident = 0;
  if (std::ifstream("/proc/self/statm") >> pages >> resident)
    usage.resident_bytes = resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::error_code failure;
  for (std::filesystem::directory_iterator file("/proc/self/fd", failure), end; !failure && file != end;
       file.increment(failure))
    ++usage.open_files;
  return usage;
}

}  // namespace

Histogram::Histogram(std::vector<double> edges) : edges_(std::move(edges)), counts_(edges_.size() + 1) {}

void Histogram::add(double seconds) {
  const auto edge = std::lower_bound(edges_.begin(), edges_.end(), seconds);
  ++counts_[static_cast<std::size_t>(edge - edges_.begin())];
  ++count_;
  sum_ += seconds;
}

double Histogram::quantile(double p) const {
  if (count_ == 0) return 0;
  const double rank = p * static_cast<double>(count_);
  double below = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const double here = static_cast<double>(counts_[i]);
    if (below + here >= rank && here > 0) {
      const double low = i == 0 ? 0 : edges_[i - 1];
      return low + (edges_[i] - low) * (rank - below) / here;
    }
    below += here;
  }
  return edges_.back();
}

void Histogram::write(std::string& out, const std::string& name, const std::string& label) const {
  const std::string first = label.empty() ? "" : label + ",", alone = label.empty() ? "" : "{" + label + "}";
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    below += counts_[i];
    out += name + "_bucket{" + first + "le=\"" + with_significant_digits(edges_[i], 9) + "\"} " +
           std::to_string(below) + "\n";
  }
  out += name + "_bucket{" + first + "le=\"+Inf\"} " + std::to_string(count_) + "\n";
  out += name + "_sum" + alone + " " + with_significant_digits(sum_, 9) + "\n";
  out += name + "_count" + alone + " " + std::to_string(count_) + "\n";
}

void Histograms::write(std::string& out, const std::string& name, const std::string& label) const {
  for (const auto& [value, histogram] : by_value_) histogram.write(out, name, label + "=\"" + value + "\"");
}

Metrics::Metrics()
    : latency(
          {1e-4, 2e-4, 5e-4, 1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3, 5e-3, 7.5e-3, 0.01, 0.015, 0.02, 0.05, 0.1, 1}),
      requests({1e-4, 1e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.5, 1, 5}),
      gpu_passes({1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.1}) {}

std::string metrics_text(const Metrics& metrics, const Gauges& gauges) {
  std::string out;
  const auto count = [&](const char* name, const char* type, const char* help, std::uint64_t value) {
    family(out, name, type, help, std::to_string(value));
  };
  count("clothlab_sessions", "gauge", "sessions open", gauges.sessions);
  count("clothlab_sessions_asleep", "gauge",
        "playing sessions that do not step because their cloth is at rest", gauges.asleep);
  count("clothlab_sessions_memory_bytes", "gauge", "buffers of the open sessions on their device",
        gauges.memory_bytes);
  count("clothlab_sessions_stuck", "gauge", "sessions whose thread does not answer", gauges.stuck);
  if (gauges.memory) {
    using Use = MemoryBudget::Use;
    const MemoryBudget& memory = *gauges.memory;
    count("clothlab_memory_limit_bytes", "gauge", "memory that the server may take (--max-memory)",
          memory.total());
    count("clothlab_memory_reserved_bytes", "gauge", "what is reserved of it, the process itself included",
          memory.used());
    count("clothlab_memory_simulations_bytes", "gauge", "of that, for scenes", memory.used(Use::simulations));
    count("clothlab_memory_timelines_bytes", "gauge", "of that, for what sessions can go back to",
          memory.used(Use::timelines));
    count("clothlab_memory_recordings_bytes", "gauge", "of that, for recordings",
          memory.used(Use::recordings));
    count("clothlab_memory_downloads_bytes", "gauge", "of that, for answers on their way",
          memory.used(Use::downloads));
  }
  head(out, "clothlab_slowest_real_time_factor", "gauge",
       "simulated seconds per second over those asked for, of the slowest session that steps; none: none "
       "steps");
  if (gauges.slowest)
    out += "clothlab_slowest_real_time_factor " + with_significant_digits(*gauges.slowest, 9) + "\n";
  count("clothlab_divergences_total", "counter", "simulations that blew up", metrics.divergences);
  count("clothlab_clients", "gauge", "WebSocket connections", gauges.clients);
  count("clothlab_viewers", "gauge", "connections subscribed to frames", gauges.viewers);
  count("clothlab_steps_total", "counter", "simulation steps",
        gauges.steps + metrics.steps_of_closed_sessions);
  count("clothlab_frames_sent_total", "counter", "frames sent", metrics.frames_sent);
  count("clothlab_frames_skipped_total", "counter", "frames replaced by newer ones before they could be sent",
        metrics.frames_skipped);
  count("clothlab_bytes_sent_total", "counter", "bytes of WebSocket messages sent", metrics.bytes_sent);
  count("clothlab_messages_received_total", "counter", "messages received", metrics.messages_received);
  count("clothlab_reading_stopped_total", "counter",
        "times a client was not read from for a while, as it took its share of the service thread's time, "
        "did not "
        "read its answers, or a long message of it was read",
        metrics.reading_stopped);
  count("clothlab_refused_total", "counter", "WebSocket handshakes and connections refused", metrics.refused);
  count("clothlab_tokens_refused_total", "counter", "tokens refused, over WebSockets and HTTP",
        metrics.tokens_refused);
  count("clothlab_over_limit_total", "counter",
        "connections closed over a limit (1008, 1009) and requests answered with -32002", metrics.over_limit);
  count("clothlab_sessions_failed_total", "counter", "sessions that failed and were not restored",
        metrics.sessions_failed);
  count("clothlab_sessions_brought_back_total", "counter", "sessions that failed and were restored",
        metrics.sessions_brought_back);
  count("clothlab_exports_waiting", "gauge", "pictures and meshes that wait or are being made",
        gauges.exports_waiting);
  count("clothlab_exports_total", "counter", "pictures and meshes made, or failed", metrics.exports);
  count("clothlab_lab_queued", "gauge", "jobs of the lab that wait", gauges.lab.queued);
  count("clothlab_lab_running", "gauge", "jobs of the lab that run", gauges.lab.running);
  count("clothlab_lab_finished_total", "counter", "jobs of the lab that finished", gauges.lab.finished);
  count("clothlab_lab_cancelled_total", "counter", "jobs of the lab that were cancelled, or left behind",
        gauges.lab.cancelled);
  count("clothlab_lab_failed_total", "counter", "jobs of the lab that failed", gauges.lab.failed);
  family(out, "clothlab_lab_seconds_total", "counter", "seconds that jobs of the lab that have ended ran",
         with_significant_digits(gauges.lab.seconds, 9));
  if (gauges.bus) {
    count("clothlab_bus_connected", "gauge", "1 if the message bus answers, else 0",
          gauges.bus->connected ? 1 : 0);
    count("clothlab_bus_messages_sent_total", "counter", "messages sent to the bus", gauges.bus->sent);
    count("clothlab_bus_bytes_sent_total", "counter", "bytes of these messages", gauges.bus->sent_bytes);
    count("clothlab_bus_messages_dropped_total", "counter",
          "messages not sent, as the bus was away or slow, and frames replaced by newer ones",
          gauges.bus->dropped);
  }
  head(out, "clothlab_frame_latency_seconds", "histogram",
       "from the request to pack a frame until its bytes are sent, without waits for the viewer");
  metrics.latency.write(out, "clothlab_frame_latency_seconds");
  family(out, "clothlab_frame_latency_p95_seconds", "gauge",
         "95th percentile of clothlab_frame_latency_seconds",
         with_significant_digits(metrics.latency.quantile(0.95), 9));
  head(out, "clothlab_request_seconds", "histogram", "from a request's arrival to its answer, by method");
  metrics.requests.write(out, "clothlab_request_seconds", "method");
  head(out, "clothlab_gpu_pass_seconds", "histogram",
       "time a pass takes on the GPU; about ten samples a second from each session");
  metrics.gpu_passes.write(out, "clothlab_gpu_pass_seconds", "pass");
  const Usage usage = usage_now();
  family(out, "process_cpu_seconds_total", "counter", "processor time of the server, all threads",
         with_significant_digits(usage.cpu_seconds, 9));
  count("process_resident_memory_bytes", "gauge", "memory of the server in RAM", usage.resident_bytes);
  count("process_open_fds", "gauge", "files and sockets open", usage.open_files);
  return out;
}

}  // namespace clothlab::net
