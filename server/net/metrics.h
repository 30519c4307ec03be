// Counters for `/metrics`, in Prometheus' text format. Only the service thread touches them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace clothlab::net {

/// How long frames lay in the server: from the end of the step they show to their bytes leaving, without the
/// time in which the viewer itself held them back.
class LatencyHistogram {
 public:
  void add(std::int64_t microseconds);
  std::uint64_t count() const { return count_; }
  /// The p-quantile, interpolated within its bucket [s]; 0 if empty.
  double quantile(double p) const;
  void write(std::string& out, const std::string& name) const;

 private:
  static constexpr std::array<std::int64_t, 16> edges{
      100, 200, 500, 1000, 1500, 2000, 3000, 4000, 5000, 7500, 10000, 15000, 20000, 50000, 100000, 1000000};
  std::array<std::uint64_t, edges.size() + 1> counts_{};  ///< the last: beyond the last edge
  std::uint64_t count_ = 0;
  double sum_ = 0;  ///< [s]
};

struct Metrics {
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_skipped = 0;  ///< replaced by a newer one before the viewer could have it
  std::uint64_t bytes_sent = 0;      ///< WebSocket payloads
  std::uint64_t messages_received = 0;
  std::uint64_t refused = 0;  ///< handshakes and connections
  std::uint64_t sessions_brought_back = 0;
  LatencyHistogram latency;
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
  std::uint64_t steps = 0;
  LabGauges lab;
  std::size_t asleep = 0;  ///< sessions whose cloth is at rest
};

std::string metrics_text(const Metrics& metrics, const Gauges& gauges);

}  // namespace clothlab::net
