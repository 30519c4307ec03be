#include "server/net/status.h"

#include <cmath>

namespace clothlab::net {

namespace {

/// What contact between surfaces has done; null where there is none: it begins with a search.
json surface_counts(const sim::Diagnostics& d) {
  if (d.surface_searches == 0) return nullptr;
  return {{"pairs", d.surface_pairs},
          {"cuts", d.surface_cuts},
          {"forced", d.surface_forced},
          {"not_taken", d.surface_not_taken},
          {"searches", d.surface_searches}};
}

/// How far the last step that was measured is from solved; null before the first, and under a method that
/// does not iterate.
json convergence_text(const sim::Convergence& of) {
  if (of.measured == 0) return nullptr;
  return {{"residual", of.residual}, {"error_m", of.error}, {"tolerance_m", of.tolerance}};
}

json hands_text(const std::vector<session::HandAt>& hands) {
  json list = json::array();
  for (const session::HandAt& at : hands)
    list.push_back({{"by", at.by},
                    {"hand", at.hand},
                    {"cloth", at.cloth},
                    {"vertex", at.vertex},
                    {"target", {at.target.x, at.target.y, at.target.z}}});
  return list;
}

}  // namespace

json status_of_session(const session::Status& status) {
  const sim::Diagnostics& d = status.diagnostics;
  return {{"playing", status.run.plays()},
          {"time", d.time},
          {"step", d.step},
          {"speed", status.speed},
          {"real_time_factor", status.real_time_factor},
          {"energy", {{"kinetic", d.kinetic}, {"elastic", d.elastic}, {"gravitational", d.gravitational}}},
          {"max_strain", d.max_strain},
          {"max_speed", d.max_speed},
          {"contacts", d.contacts},
          {"convergence", convergence_text(status.convergence)},
          {"surface", surface_counts(d)},
          {"hands", hands_text(status.hands)},
          {"memory_bytes", status.memory_bytes},
          {"stability",
           {{"dt_limit", std::isfinite(status.dt_limit) ? json(status.dt_limit) : json(nullptr)},
            {"margin", status.margin ? json(*status.margin) : json(nullptr)}}},
          {"diverged", status.run.diverged()}};
}

}  // namespace clothlab::net
