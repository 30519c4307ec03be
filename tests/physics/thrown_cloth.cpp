#include "tests/physics/thrown_cloth.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "server/model/bodies.h"
#include "server/model/stability.h"
#include "server/scene/fabrics.h"
#include "server/scene/method.h"
#include "tests/body_meshes.h"

namespace clothlab::test {

namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  double uniform(double least, double most) {
    return least + (most - least) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  double spread(double least, double most) { return least * std::pow(most / least, uniform(0.0, 1.0)); }
  int whole(int least, int most) { return least + static_cast<int>(uniform(0.0, most - least + 1.0)); }
  bool chance(double share) { return uniform(0.0, 1.0) < share; }
  glm::dvec3 direction() {
    glm::dvec3 v;
    do v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    while (glm::length(v) > 1.0 || glm::length(v) < 0.1);
    return glm::normalize(v);
  }

 private:
  std::mt19937_64 random_;
};

constexpr double body_size = 0.5;  // radius, or half of a plate's side [m]

scene::TriangleMesh random_mesh(Random& random, bool heavy, ThrownCloth& made) {
  switch (random.whole(0, 2)) {
    case 0: {
      made.plate = true;
      const int columns = heavy ? random.whole(20, 158) : random.whole(7, 27);
      made.words += "plate of " + std::to_string(2 * columns * columns);
      return plate_mesh(static_cast<std::uint32_t>(columns));
    }
    case 1: {
      const int times = heavy ? random.whole(3, 5) : random.whole(1, 3);
      made.words += "ball of " + std::to_string(20 << (2 * times));
      return ball_mesh(times);
    }
    default: {
      const int times = heavy ? random.whole(3, 5) : random.whole(2, 3);
      made.words += "bowl of about " + std::to_string(10 << (2 * times));
      return lower_half(ball_mesh(times));
    }
  }
}

scene::Motion random_motion(Random& random, ThrownCloth& made) {
  if (random.chance(0.5)) {
    made.words += " triangles at rest";
    return {};
  }
  made.moves = true;
  made.words += " triangles that move";
  switch (random.whole(0, 2)) {
    case 0:
      return scene::Linear{random.direction() * random.spread(0.01, 10.0)};
    case 1: {
      const double frequency = random.spread(0.2, 5.0);
      return scene::Oscillate{random.direction(), random.spread(0.01, 1.0) / frequency, frequency};
    }
    default:
      return scene::Spin{random.direction(), glm::dvec3(0.0), random.spread(10.0, 1000.0)};
  }
}

scene::Material random_material(Random& random, ThrownCloth& made, scene::Cloth& cloth) {
  if (random.chance(0.5)) {
    made.words += ", soft springs";
    cloth.mass = {scene::Mass::Kind::per_vertex, 0.001};
    return scene::Springs{10.0, 5.0, 1.0, 0.02};
  }
  made.words += ", cotton";
  const std::vector<scene::Fabric>& fabrics = *scene::fabrics();
  const scene::Fabric& cotton = *std::find_if(
      fabrics.begin(), fabrics.end(), [](const scene::Fabric& fabric) { return fabric.name == "cotton"; });
  cloth.mass = {scene::Mass::Kind::area_density, cotton.area_density};
  return cotton.sheet;
}

}  // namespace

ThrownCloth thrown_cloth(std::uint64_t seed, bool heavy) {
  Random random(seed);
  ThrownCloth made;
  made.words = "seed " + std::to_string(seed) + ": ";
  scene::Scene& scene = made.scene;
  scene::Transform place;
  place.scale = body_size;
  scene::TriangleMesh mesh = random_mesh(random, heavy, made);
  if (made.plate) place.scale = 2.0 * body_size;
  scene.colliders = {body_of(std::move(mesh), place, random_motion(random, made))};
  scene::Cloth& cloth = scene.cloths.emplace_back();
  const int side = random.whole(5, heavy ? 17 : 11);
  const double width = random.uniform(0.1, 0.3), edge = width / (side - 1);
  cloth.mesh = scene::Grid{side, side, width, width};
  cloth.material = random_material(random, made, cloth);
  cloth.transform.rotate = {random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180)};
  const double thickness = std::min(random.spread(0.001, 0.01), 0.3 * edge);
  scene.self_collision =
      scene::SelfCollision{thickness, random.uniform(0.0, 0.6), scene::ContactKind::surface};
  scene::Method method = scene::methods[static_cast<std::size_t>(random.whole(0, 7))];
  if (method == scene::Method::pbd && std::holds_alternative<scene::Fem>(cloth.material))
    method = scene::Method::xpbd;  // PBD has no sheets of finite elements
  double dt = random.spread(1e-5, 1.0);
  if (!scene::any_step_is_stable(method)) {
    scene::Scene alone;  // the cloth has no place yet
    alone.cloths = scene.cloths;
    alone.solver = {method, 1e-4, 1, 1e-4};
    const Result<model::Model> model = model::build(alone);
    if (!model) throw std::runtime_error(made.words + ": " + model.error().text());
    const double limit = model::dt_limit_bound(*model, alone);
    dt = 0.5 * std::min(2.0 * dt, limit);
  }
  scene.solver = {method, dt, random.whole(1, 10), 1e-4};
  // Thrown from above the body, at a point of it; a plate from either side.
  const double speed = random.spread(0.1, 50.0), gap = std::max(0.03, std::min(0.5, 10.0 * speed * dt));
  const glm::dvec3 aim = glm::dvec3(random.uniform(-0.2, 0.2), 0.0, random.uniform(-0.2, 0.2));
  const double side_of_plate = made.plate && random.chance(0.5) ? -1.0 : 1.0;
  const double above = (made.plate ? 0.0 : body_size) + 1.12 * width + gap;  // its farthest corner
  const glm::dvec3 from = aim + glm::dvec3(0.0, side_of_plate * above, 0.0);
  cloth.transform.translate = from;
  made.velocity = glm::vec3(glm::normalize(aim - from) * speed);
  made.spin = glm::vec3(random.direction() * random.spread(0.1, 100.0));
  made.steps =
      static_cast<int>(std::clamp(2.0 * (gap + 2.2 * width) / (speed * dt), 4.0, heavy ? 20.0 : 40.0));
  made.words += ", " + std::to_string(side) + " vertices a side, " + scene::name(method) + ", dt " +
                std::to_string(dt * 1e3) + " ms, " + std::to_string(speed) + " m/s, thickness " +
                std::to_string(thickness * 1e3) + " mm";
  return made;
}

Watched::Watched(const ThrownCloth& thrown, sim::Simulation& simulation)
    : thrown_(thrown), simulation_(simulation), surfaces_(model::surfaces_of(simulation.model())) {
  sim::State state = simulation.read_state();
  glm::vec3 middle(0.0f);
  for (const glm::vec3& x : state.position) middle += x / static_cast<float>(state.position.size());
  for (std::size_t i = 0; i < state.position.size(); ++i)
    state.velocity[i] = thrown.velocity + glm::cross(thrown.spin, state.position[i] - middle);
  simulation.restore(state, 0.0, 0);
}

/// A vertex has gone through the plate if it has changed sides, and both places lie so far within the plate's
/// rim that no way around it is as short.
std::string Watched::through_plate(const std::vector<glm::dvec3>& x, const std::vector<glm::dvec3>& body) {
  const std::size_t columns = static_cast<std::size_t>(std::lround(std::sqrt(double(body.size())))) - 1;
  const glm::dvec3 origin = body[0], u = body[columns] - origin, w = body[columns * (columns + 1)] - origin,
                   n = glm::normalize(glm::cross(w, u));
  std::vector<glm::dvec3> seen;
  for (const glm::dvec3& at : x)
    seen.emplace_back(glm::dot(at - origin, u) / glm::dot(u, u), glm::dot(at - origin, n),
                      glm::dot(at - origin, w) / glm::dot(w, w));
  std::string found;
  for (std::size_t i = 0; i < in_plate_.size() && found.empty(); ++i) {
    const double way = glm::length(seen[i] - in_plate_[i]);
    const auto within = [&](const glm::dvec3& at) {
      return std::min(std::min(at.x, 1.0 - at.x), std::min(at.z, 1.0 - at.z)) > way;
    };
    if (seen[i].y * in_plate_[i].y < 0.0 && within(seen[i]) && within(in_plate_[i]))
      found = "vertex " + std::to_string(i) + " went through the plate";
  }
  in_plate_ = std::move(seen);
  return found;
}

std::string Watched::wrong() {
  const sim::State state = simulation_.read_state();
  std::vector<glm::dvec3> x(state.position.begin(), state.position.end());
  const auto finite = [](const glm::dvec3& v) { return std::isfinite(v.x + v.y + v.z); };
  if (!std::all_of(x.begin(), x.end(), finite)) return "";  // a blow-up, which is told
  const std::vector<glm::dvec3> body = model::body_positions(simulation_.model(), simulation_.time());
  std::string found = thrown_.plate ? through_plate(x, body) : "";
  for (const glm::dvec3& at : body) x.emplace_back(glm::vec3(at));
  if (const std::uint64_t count = model::find_crossings(surfaces_, x).count; count > 0)
    found = std::to_string(count) + " crossings";
  if (found.empty()) return "";
  const sim::Diagnostics state_now = simulation_.diagnose();
  if (thrown_.moves && state_now.surface_forced > 0) return "";
  return found + " at step " + std::to_string(simulation_.step_index()) + ", forced " +
         std::to_string(state_now.surface_forced) + "\n" + thrown_.words;
}

}  // namespace clothlab::test
