#include "server/lab/job.h"

#include <chrono>

#include "server/base/utc.h"
#include "server/lab/scene_hash.h"

namespace clothlab::lab {

namespace {

Origin origin_now(const scene::Document& document) {
  Hash hash;
  add_scene(hash, document);
  return {hash.text(), utc_text(std::chrono::system_clock::now())};
}

Outcome stamped(Outcome outcome, const Origin& origin) {
  std::visit([&](auto& result) { result.origin = origin; }, outcome);
  return outcome;
}

/// Runs one kind of job; what arrives is passed on to `control`, the control for any kind.
template <class Kind, class Input, class Request>
Result<Outcome> run_as(Result<Kind> (*job)(const Input&, const Request&, const Control<Kind>&),
                       const Input& input, const Request& request, const Control<Outcome>& control,
                       const Origin& origin) {
  const auto arrived = [&](const Kind& so_far) { control.arrived(stamped(so_far, origin)); };
  Result<Kind> result = job(input, request, {control.stop, control.progress, arrived});
  if (!result) return result.error();
  return stamped(std::move(*result), origin);
}

}  // namespace

Result<Outcome> run(const scene::Document& document, const Job& job, const Control<Outcome>& control) {
  const Origin origin = origin_now(document);
  if (const auto* request = std::get_if<ChartRequest>(&job))
    return run_as(&chart, document.scene, *request, control, origin);
  if (const auto* request = std::get_if<MapRequest>(&job))
    return run_as(&stability_map, document, *request, control, origin);
  if (const auto* request = std::get_if<ChooseRequest>(&job))
    return run_as(&choose, document.scene, *request, control, origin);
  if (const auto* request = std::get_if<SimplifyRequest>(&job))
    return run_as(&simplify, document, *request, control, origin);
  return run_as(&compare, document, std::get<CompareRequest>(job), control, origin);
}

}  // namespace clothlab::lab
