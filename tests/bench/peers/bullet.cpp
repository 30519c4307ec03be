// peer_bullet classic|deformable SCENE FOLDER: simulates a scene (peer.h) with Bullet, writes
// each sample to FOLDER/frame-NNNN.obj, and prints what stepping cost, as JSON.
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "tests/bench/peers/peer.h"

namespace {

using namespace clothlab::peers;

/// Nine digits: every 32-bit float has its own.
void write(const std::string& folder, int sample, const Scene& scene, const std::vector<dvec3>& positions) {
  char name[32];
  std::snprintf(name, sizeof name, "/frame-%04d.obj", sample);
  std::FILE* file = std::fopen((folder + name).c_str(), "w");
  if (!file) throw std::runtime_error("cannot write to " + folder);
  for (const dvec3& x : positions) std::fprintf(file, "v %.9g %.9g %.9g\n", x.x, x.y, x.z);
  for (const auto& [a, b, c] : scene.triangles) std::fprintf(file, "f %d %d %d\n", a + 1, b + 1, c + 1);
  std::fclose(file);
}

}  // namespace

int main(int count, char** words) try {
  if (count != 4) throw std::runtime_error("usage: peer_bullet classic|deformable SCENE FOLDER");
  const Scene scene = load(words[2]);
  const std::unique_ptr<World> world =
      std::string(words[1]) == "classic" ? classic(scene) : deformable(scene);
  write(words[3], 0, scene, world->positions());
  std::chrono::duration<double> stepping{0.0};
  for (int step = 1; step <= scene.steps; ++step) {
    const auto before = std::chrono::steady_clock::now();
    world->step(step * scene.dt);
    stepping += std::chrono::steady_clock::now() - before;
    if (step % scene.steps_a_sample == 0)
      write(words[3], step / scene.steps_a_sample, scene, world->positions());
  }
  std::printf("{\"step_s\": %.9g, \"steps\": %d, \"vertices\": %zu}\n", stepping.count(), scene.steps,
              scene.vertices.size());
} catch (const std::exception& wrong) {
  std::fprintf(stderr, "peer_bullet: %s\n", wrong.what());
  return 1;
}
