#include "server/lab/job.h"

namespace clothlab::lab {

namespace {

/// The control for one kind of job, which passes everything on to `control`, the control for any kind.
template <class Kind>
Control<Kind> control_of(const Control<Outcome>& control) {
  return {control.stop, control.progress, [&control](const Kind& so_far) { control.arrived(so_far); }};
}

template <class Kind>
Result<Outcome> outcome(Result<Kind> result) {
  if (!result) return result.error();
  return Outcome(std::move(*result));
}

}  // namespace

Result<Outcome> run(const scene::Document& document, const Job& job, const Control<Outcome>& control) {
  if (const auto* request = std::get_if<ChartRequest>(&job))
    return outcome(chart(document.scene, *request, control_of<Chart>(control)));
  if (const auto* request = std::get_if<MapRequest>(&job))
    return outcome(stability_map(document, *request, control_of<StabilityMap>(control)));
  if (const auto* request = std::get_if<ChooseRequest>(&job))
    return outcome(choose(document.scene, *request, control_of<Choice>(control)));
  if (const auto* request = std::get_if<SimplifyRequest>(&job))
    return outcome(simplify(document, *request, control_of<Simplification>(control)));
  return outcome(compare(document, std::get<CompareRequest>(job), control_of<Comparison>(control)));
}

}  // namespace clothlab::lab
