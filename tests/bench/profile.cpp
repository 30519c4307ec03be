// Where the time of a scene's steps goes, by pass: each dispatch alone, waited for.
//   bench_profile SCENE FROM TO [POINTER=VALUE]...
// SCENE: a preset or a file. The steps from time FROM to time TO [s] are timed; the values are set in the
// scene first. Prints a line of JSON. The waits take time, too: `unwaited_ms_per_step` is what a step takes
// without them, of the same steps in a second run.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include "server/base/files.h"
#include "server/gl/context.h"
#include "server/scene/document.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"

using namespace clothlab;

namespace {

struct Pass {
  double seconds = 0.0;
  std::uint64_t dispatches = 0, groups = 0;
};
std::map<GLuint, Pass> passes;
bool timed = false;
PFNGLDISPATCHCOMPUTEPROC direct = nullptr;
PFNGLDISPATCHCOMPUTEINDIRECTPROC indirect = nullptr;

template <typename Dispatch>
void time_pass(std::uint64_t groups, Dispatch dispatch) {
  if (!timed) return dispatch();
  glFinish();
  const double start = bench::seconds();
  dispatch();
  glFinish();
  GLint program = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &program);
  Pass& pass = passes[static_cast<GLuint>(program)];
  pass.seconds += bench::seconds() - start;
  ++pass.dispatches;
  pass.groups += groups;
}

void GLAD_API_PTR time_direct(GLuint x, GLuint y, GLuint z) {
  time_pass(std::uint64_t{x} * y * z, [&] { direct(x, y, z); });
}

void GLAD_API_PTR time_indirect(GLintptr offset) {
  GLuint groups[3] = {};
  if (timed) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetBufferSubData(GL_DISPATCH_INDIRECT_BUFFER, offset, sizeof groups, groups);
  }
  time_pass(std::uint64_t{groups[0]} * groups[1] * groups[2], [&] { indirect(offset); });
}

std::string label(GLuint program) {
  char text[256] = "";
  glGetObjectLabel(GL_PROGRAM, program, sizeof text, nullptr, text);
  return text;
}

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return 2;
}

Result<scene::Document> load(const std::string& name, int argc, char** argv) {
  Result<scene::Document> document = scene::load(name);
  for (int i = 4; i < argc && document; ++i) document = scene::set_value(*document, argv[i]);
  return document;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fputs("usage: bench_profile SCENE FROM TO [POINTER=VALUE]...\n", stderr), 2;
  const Result<scene::Document> document = load(argv[1], argc, argv);
  if (!document) return fail(document.error());
  const auto context = gl::Context::create();
  if (!context) return fail(context.error());
  direct = glad_glDispatchCompute;
  indirect = glad_glDispatchComputeIndirect;
  glad_glDispatchCompute = time_direct;
  glad_glDispatchComputeIndirect = time_indirect;

  const double dt = document->scene.solver.dt;
  const auto before = static_cast<std::uint32_t>(std::atof(argv[2]) / dt + 0.5);
  const auto steps = static_cast<std::uint32_t>(std::atof(argv[3]) / dt + 0.5) - before;
  double took[2] = {};
  std::uint32_t vertices = 0;
  for (const bool waits : {false, true}) {
    Result<std::unique_ptr<sim::Simulation>> made = sim::Simulation::create(document->scene);
    if (!made) return fail(made.error());
    sim::Simulation& simulation = **made;
    vertices = simulation.model().vertex_count();
    simulation.step(before + steps);  // compiles what these steps need
    simulation.reset();
    simulation.step(before);
    simulation.finish();
    const std::uint32_t searches_before = simulation.diagnose().surface_searches;
    const double start = bench::seconds();
    timed = waits;
    simulation.step(steps);
    simulation.finish();
    timed = false;
    took[waits] = bench::seconds() - start;
    if (!waits) continue;
    std::printf("{\"scene\": \"%s\", \"vertices\": %u, \"dt\": %g, \"steps\": %u,\n", argv[1], vertices, dt,
                steps);
    std::printf(" \"unwaited_ms_per_step\": %.4f, \"ms_per_step\": %.4f, \"passes\": [",
                1e3 * took[0] / steps, 1e3 * took[1] / steps);
    const char* separator = "\n";
    for (const auto& [program, pass] : passes) {
      std::printf(
          "%s  {\"pass\": \"%s\", \"ms_per_step\": %.4f, \"dispatches_per_step\": %.2f, \"groups\": %.1f}",
          separator, label(program).c_str(), 1e3 * pass.seconds / steps,
          static_cast<double>(pass.dispatches) / steps,
          static_cast<double>(pass.groups) / static_cast<double>(pass.dispatches));
      separator = ",\n";
    }
    const sim::Diagnostics seen = simulation.diagnose();
    std::printf("],\n \"surface_pairs\": %u, \"surface_searches\": %u}\n", seen.surface_pairs,
                seen.surface_searches - searches_before);
  }
}
