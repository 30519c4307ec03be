// What `/metrics` tells, in Prometheus' text format. Only the service thread touches it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace clothlab::net {

/// How often durations fell between fixed edges.
class Histogram {
 public:
  explicit Histogram(std::vector<double> edges);  ///< ascending [s]
  void add(double seconds);
  std::uint64_t count() const { return count_; }
  /// The p-quantile, interpolated within its bucket [s]; 0 if empty.
  double quantile(double p) const;
  /// Appends its lines; `label` is `name="value"`, or empty.
  void write(std::string& out, const std::string& name, const std::string& label = "") const;

 private:
  std::vector<double> edges_;
  std::vector<std::uint64_t> counts_;  ///< the last: beyond the last edge
  std::uint64_t count_ = 0;
  double sum_ = 0;  ///< [s]
};

/// Histograms of one family, by the value of its label.
class Histograms {
 public:
  explicit Histograms(std::vector<double> edges) : edges_(std::move(edges)) {}
  Histogram& operator[](const std::string& value) {
    return by_value_.try_emplace(value, edges_).first->second;
  }
  void write(std::string& out, const std::string& name, const std::string& label) const;

 private:
  std::vector<double> edges_;
  std::map<std::string, Histogram> by_value_;
};

struct Metrics {
  Metrics();
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_skipped = 0;  ///< replaced by a newer one before the viewer could have it
  std::uint64_t bytes_sent = 0;      ///< WebSocket payloads
  std::uint64_t messages_received = 0;
  std::uint64_t refused = 0;  ///< handshakes and connections
  std::uint64_t sessions_brought_back = 0;
  std::uint64_t exports = 0;  ///< pictures and meshes made, or failed
  std::uint64_t steps_of_closed_sessions = 0;
  /// How long frames lay in the server: from the end of the step they show to their bytes leaving, without
  /// the time in which the viewer itself held them back.
  Histogram latency;
  Histograms requests;    ///< from a request's arrival to its answer, by method
  Histograms gpu_passes;  ///< what a pass took on the GPU, sampled
};

/// The lab's jobs by state, those that have ended in all, and what they took.
struct LabGauges {
  std::size_t queued = 0, running = 0;
  std::uint64_t finished = 0, cancelled = 0, failed = 0;
  double seconds = 0;
};

/// What is counted elsewhere and asked for at the moment.
struct Gauges {
  std::size_t sessions = 0, clients = 0, viewers = 0;
  std::uint64_t steps = 0;  ///< of the sessions that are open
  LabGauges lab;
  std::size_t asleep = 0;           ///< sessions whose cloth is at rest
  std::size_t exports_waiting = 0;  ///< pictures and meshes that wait or are being made
};

std::string metrics_text(const Metrics& metrics, const Gauges& gauges);

}  // namespace clothlab::net
