// The server's counters and histograms, which `/metrics` shows in Prometheus' text format. Only the service
// thread uses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/memory_budget.h"
#include "server/bus/bus.h"

namespace clothlab::net {

/// Counts durations [s] in buckets between fixed edges.
class Histogram {
 public:
  explicit Histogram(std::vector<double> edges);  ///< in ascending order [s]
  void add(double seconds);
  std::uint64_t count() const { return count_; }
  /// The p-quantile [s], interpolated within its bucket, at most the last edge; 0 without durations.
  double quantile(double p) const;
  /// Appends the histogram's lines to `out`; `label` is `name="value"`, or empty.
  void write(std::string& out, const std::string& name, const std::string& label = "") const;

 private:
  std::vector<double> edges_;
  std::vector<std::uint64_t> counts_;  ///< [edges + 1]; the last counts durations beyond the last edge
  std::uint64_t count_ = 0;
  double sum_ = 0;  ///< of all durations [s]
};

/// The histograms of one metric, one for each value of its label.
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
  std::uint64_t frames_skipped = 0;  ///< replaced by newer frames before they could be sent
  std::uint64_t bytes_sent = 0;      ///< WebSocket payloads
  std::uint64_t messages_received = 0;
  std::uint64_t reading_stopped = 0;  ///< times that a client was not read from for a while
  std::uint64_t refused = 0;          ///< refused handshakes and connections
  std::uint64_t tokens_refused = 0;   ///< wrong ones, and those not checked after many wrong ones
  std::uint64_t over_limit = 0;       ///< connections closed with 1008 or 1009, and errors -32002
  std::uint64_t divergences = 0;      ///< simulations that have blown up
  std::uint64_t sessions_brought_back = 0;
  std::uint64_t sessions_failed = 0;  ///< that were not brought back
  std::uint64_t exports = 0;          ///< pictures and meshes made, failed ones included
  std::uint64_t steps_of_closed_sessions = 0;
  /// Time that sent frames spent in the server [s]: from the request to pack a frame, after its steps, until
  /// its bytes left, without the time for which the viewer's rate or acknowledgements held it back.
  Histogram latency;
  Histograms requests;    ///< time from a request's arrival to its answer, by method [s]
  Histograms gpu_passes;  ///< time that a pass took on the GPU, by pass [s]; samples only
};

/// Numbers of the lab's jobs: those that wait and run now, and all that have ended so far.
struct LabGauges {
  std::size_t queued = 0, running = 0;
  std::uint64_t finished = 0, cancelled = 0, failed = 0;
  double seconds = 0;  ///< run time of all jobs that have ended [s]
};

/// Present values that other parts of the server keep; Hub::gauges collects them for `/metrics`.
struct Gauges {
  std::size_t sessions = 0, clients = 0, viewers = 0;
  std::uint64_t steps = 0;  ///< of the open sessions, since each was opened
  LabGauges lab;
  std::size_t asleep = 0;           ///< sessions whose cloth is at rest
  std::size_t exports_waiting = 0;  ///< pictures and meshes that wait or are being made
  std::size_t stuck = 0;            ///< sessions whose thread does not answer; /healthz is 503 then
  std::optional<double> slowest{};  ///< the least Room::pace; none: no session steps
  std::uint64_t memory_bytes = 0;   ///< of all buffers of the open sessions on their device
  std::shared_ptr<const MemoryBudget> memory{};  ///< null: not bounded
  std::optional<bus::Counts> bus{};              ///< none: without a message bus
};

std::string metrics_text(const Metrics& metrics, const Gauges& gauges);

}  // namespace clothlab::net
