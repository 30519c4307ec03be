// Every program of every preset links, and the device allows what they need.
#include <optional>

#include "server/model/hold.h"
#include "server/render/renderer.h"
#include "server/scene/document.h"
#include "server/scene/suited.h"
#include "server/selftest/checks.h"
#include "server/selftest/needs.h"
#include "server/sim/hands.h"
#include "server/stream/field_pass.h"
#include "server/stream/packer.h"

namespace clothlab::selftest {

namespace {

/// What is linked under one heading: by how many programs more, or why not.
Check linked(const std::string& name, const ProgramWatch& watch, std::size_t before,
             const std::vector<Error>& failures, const std::string& how) {
  const std::size_t more = watch.linked() - before;
  Check check{name,
              failures.empty(),
              failures.size(),
              0,
              "",
              how + ": all programs link" + (more > 0 ? ", " + std::to_string(more) + " more" : ""),
              ""};
  if (failures.empty()) return check;
  check.said = std::to_string(failures.size()) + " do not link; " + failures.front().where + ": " +
               failures.front().what;
  check.remedy = failures.front().remedy;
  return check;
}

Result<Check> check_preset(const std::string& preset, bool quick, const ProgramWatch& watch) {
  const Result<scene::Document> document = scene::load_preset(preset);
  if (!document) return document.error();
  scene::Scene scene = document->scene;
  std::vector<scene::Method> methods{scene.solver.method};
  if (!quick || preset == "seed") methods = *scene::suited_methods(scene, {});
  const std::size_t before = watch.linked();
  std::vector<Error> failures;
  for (const scene::Method method : methods) {
    scene.solver.method = method;
    const auto simulation = sim::Simulation::create(scene);
    if (simulation) continue;
    failures.push_back(simulation.error());
    failures.back().what += std::string(" (under ") + scene::name(method) + ")";
  }
  return linked(
      "programs: " + preset, watch, before, failures,
      methods.size() == 1 ? scene::name(methods[0]) : "under " + std::to_string(methods.size()) + " methods");
}

/// What does not step the cloth: hands on it, frames, fields, pictures.
Result<Check> check_others(const ProgramWatch& watch) {
  const Result<scene::Document> document = scene::load_preset("seed");
  if (!document) return document.error();
  const auto simulation = sim::Simulation::create(document->scene);
  if (!simulation) return simulation.error();
  const std::size_t before = watch.linked();
  std::vector<Error> failures;
  const auto keep = [&](const auto& made) {
    if (!made) failures.push_back(made.error());
  };
  const model::Model& model = (*simulation)->model();
  const auto hold = std::make_shared<const model::Hold>(
      model::hold_on(model, document->scene, model.vertex_count() - 1, (*simulation)->read_state().position));
  keep((*simulation)->set_hands({{hold, {0.0, 2.0, 0.0}}}));
  keep(stream::Packer::create());
  keep(stream::FieldPass::create());
  keep(render::Renderer::create());
  return linked("programs: hands, frames and pictures", watch, before, failures, "for every scene");
}

}  // namespace

void check_programs(Report& report, bool quick) {
  const ProgramWatch watch;
  for (const std::string& preset : scene::preset_names())
    report.make("programs: " + preset, [&] { return check_preset(preset, quick, watch); });
  report.make("programs: hands, frames and pictures", [&] { return check_others(watch); });
  for (Check& check : watch.limits()) report.add(std::move(check));
}

}  // namespace clothlab::selftest
