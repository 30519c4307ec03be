#include "server/net/lab_entry.h"

#include "server/base/log.h"
#include "server/base/text.h"
#include "server/lab/exports.h"
#include "server/sim/simulation.h"

namespace clothlab::net {

namespace {

/// The scene with the usual value of each setting that the job ignores: charts and choices try their own
/// methods, time steps and iterations, a map its own methods and time steps.
scene::Scene as_seen_by(const lab::Job& job, scene::Scene scene) {
  if (std::holds_alternative<lab::SimplifyRequest>(job) || std::holds_alternative<lab::CompareRequest>(job))
    return scene;
  const scene::Solver usual;
  scene.solver.method = usual.method;
  scene.solver.dt = usual.dt;
  if (!std::holds_alternative<lab::MapRequest>(job)) scene.solver.iterations = usual.iterations;
  return scene;
}

}  // namespace

const char* name(LabEntry::State state) {
  using State = LabEntry::State;
  switch (state) {
    case State::asked:
    case State::queued:
    case State::holding:
      return "queued";
    case State::running:
      return "running";
    case State::finished:
      return "finished";
    case State::cancelled:
      return "cancelled";
    case State::failed:
      return "failed";
  }
  return "";
}

bool LabEntry::stale_if(const scene::Scene& present) const {
  return sim::change_depth(as_seen_by(job, document->scene), as_seen_by(job, present)) !=
         sim::ChangeDepth::none;
}

json LabEntry::summary() const {
  return {{"job", id},
          {"kind", lab::name(job)},
          {"state", name(state)},
          {"stale", stale},
          {"revision", revision}};
}

json LabEntry::progress_message() const {
  return {{"job", id},
          {"kind", lab::name(job)},
          {"state", name(state)},
          {"ahead", ahead},
          {"done", progress.done},
          {"total", progress.total},
          {"doing", progress.doing},
          {"stale", stale}};
}

json LabEntry::result_message() const {
  json message = summary();
  message["cached"] = cached;
  message["beside"] = disturbed;
  message["result"] = outcome ? lab::to_json(*outcome) : json(nullptr);
  if (error) message["error"] = {{"path", error->where}, {"found", error->what}, {"allowed", error->remedy}};
  return message;
}

void LabEntry::log_end(double seconds) const {
  std::vector<LogField> fields{{"job", std::to_string(id)},
                               {"kind", lab::name(job)},
                               {"session", session},
                               {"state", name(state)},
                               {"seconds", formatted("%.1f", seconds)}};
  if (cached) fields.push_back({"cached", "true"});
  if (disturbed) fields.push_back({"beside", "true"});
  if (error) fields.push_back({"why", error->text()});
  log(state == State::failed ? LogLevel::warning : LogLevel::info, "lab_job_ended", fields);
}

}  // namespace clothlab::net
