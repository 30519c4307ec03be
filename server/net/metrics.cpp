#include "server/net/metrics.h"

#include <algorithm>

#include "server/base/text.h"

namespace clothlab::net {

namespace {

void family(std::string& out, const std::string& name, const char* type, const char* help,
            const std::string& value) {
  out += "# HELP " + name + " " + help + "\n# TYPE " + name + " " + type + "\n" + name + " " + value + "\n";
}

}  // namespace

void LatencyHistogram::add(std::int64_t microseconds) {
  const auto edge = std::lower_bound(edges.begin(), edges.end(), microseconds);
  ++counts_[static_cast<std::size_t>(edge - edges.begin())];
  ++count_;
  sum_ += 1e-6 * static_cast<double>(microseconds);
}

double LatencyHistogram::quantile(double p) const {
  if (count_ == 0) return 0;
  const double rank = p * static_cast<double>(count_);
  double below = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double here = static_cast<double>(counts_[i]);
    if (below + here >= rank && here > 0) {
      const double low = i == 0 ? 0 : static_cast<double>(edges[i - 1]);
      return 1e-6 * (low + (static_cast<double>(edges[i]) - low) * (rank - below) / here);
    }
    below += here;
  }
  return 1e-6 * static_cast<double>(edges.back());
}

void LatencyHistogram::write(std::string& out, const std::string& name) const {
  out += "# HELP " + name + " from the end of a step to its frame's bytes leaving\n# TYPE " + name +
         " histogram\n";
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    below += counts_[i];
    out += name + "_bucket{le=\"" + significant(1e-6 * static_cast<double>(edges[i]), 9) + "\"} " +
           std::to_string(below) + "\n";
  }
  out += name + "_bucket{le=\"+Inf\"} " + std::to_string(count_) + "\n";
  out += name + "_sum " + significant(sum_, 9) + "\n" + name + "_count " + std::to_string(count_) + "\n";
}

std::string metrics_text(const Metrics& metrics, const Gauges& gauges) {
  std::string out;
  const auto count = [&](const char* name, const char* type, const char* help, std::uint64_t value) {
    family(out, name, type, help, std::to_string(value));
  };
  count("clothlab_sessions", "gauge", "sessions open", gauges.sessions);
  count("clothlab_sessions_asleep", "gauge", "sessions that play and do not step, their cloth at rest",
        gauges.asleep);
  count("clothlab_clients", "gauge", "WebSocket connections", gauges.clients);
  count("clothlab_viewers", "gauge", "connections subscribed to frames", gauges.viewers);
  count("clothlab_steps_total", "counter", "simulation steps of the open sessions", gauges.steps);
  count("clothlab_frames_sent_total", "counter", "frames sent", metrics.frames_sent);
  count("clothlab_frames_skipped_total", "counter", "frames replaced by newer ones before they could be sent",
        metrics.frames_skipped);
  count("clothlab_bytes_sent_total", "counter", "bytes of WebSocket messages sent", metrics.bytes_sent);
  count("clothlab_messages_received_total", "counter", "messages received", metrics.messages_received);
  count("clothlab_refused_total", "counter", "WebSocket handshakes and connections refused", metrics.refused);
  count("clothlab_sessions_brought_back_total", "counter", "sessions that failed and went on",
        metrics.sessions_brought_back);
  count("clothlab_lab_queued", "gauge", "jobs of the lab that wait", gauges.lab.queued);
  count("clothlab_lab_running", "gauge", "jobs of the lab that run", gauges.lab.running);
  count("clothlab_lab_finished_total", "counter", "jobs of the lab that finished", gauges.lab.finished);
  count("clothlab_lab_cancelled_total", "counter", "jobs of the lab that were cancelled, or left behind",
        gauges.lab.cancelled);
  count("clothlab_lab_failed_total", "counter", "jobs of the lab that failed", gauges.lab.failed);
  family(out, "clothlab_lab_seconds_total", "counter", "seconds that jobs of the lab that have ended ran",
         significant(gauges.lab.seconds, 9));
  metrics.latency.write(out, "clothlab_frame_latency_seconds");
  family(out, "clothlab_frame_latency_p95_seconds", "gauge",
         "95th percentile of clothlab_frame_latency_seconds", significant(metrics.latency.quantile(0.95), 9));
  return out;
}

}  // namespace clothlab::net
