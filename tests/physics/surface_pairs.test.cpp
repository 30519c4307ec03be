// The search of contact between surfaces: as long as it asks for no new search, its list has all pairs that
// are near.
#include "server/sim/surface_pairs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <set>

#include "server/sim/motion_table.h"
#include "server/sim/state.h"
#include "server/sim/surface_control.h"
#include "shaders/elements/elements.h"
#include "shaders/slots.h"
#include "tests/crossings.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

constexpr int side = 9;
constexpr double size = 0.2;

/// Two sheets, one above the other and turned.
scene::Scene two_sheets(double thickness) {
  scene::Scene scene;
  scene.self_collision = scene::SelfCollision{thickness, 0.3, scene::ContactKind::surface};
  for (const double height : {0.0, 0.03}) {
    scene::Cloth& cloth = scene.cloths.emplace_back();
    cloth.mesh = scene::Grid{side, side, size, size};
    cloth.transform = {{0.0, height, -0.5 * size}, {0.0, 1000.0 * height, 0.0}, 1.0};
    cloth.mass = {scene::Mass::Kind::per_vertex, 0.001};
  }
  return scene;
}

/// The place of a vertex of two sheets that swing by turns about an axis, as one, while each is waved and
/// stretched by itself, so that places of both come near each other here and there.
glm::vec3 moved(const glm::dvec3& x, bool upper, double time) {
  const double phase = upper ? 1.3 : 0.0, wave = 0.02 * std::sin(40.0 * x.x + 6.0 * time + phase);
  const glm::dvec3 bent(x.x * (1.0 + 0.8 * std::sin(5.0 * time + phase)),
                        x.y + wave - (upper ? 0.02 * std::min(time, 1.0) : 0.0), x.z);
  const double angle = 2.0 * std::sin(2.0 * time), c = std::cos(angle), s = std::sin(angle);
  return {c * bent.x - s * (bent.y + 0.5), s * bent.x + c * (bent.y + 0.5), bent.z + 0.3 * time};
}

using Corners = std::array<std::uint32_t, 4>;

/// A pair in one form, whichever of its parts comes first and in whatever order its corners are.
Corners in_order(bool edges, Corners c) {
  std::sort(c.begin() + (edges ? 2 : 1), c.end());
  if (!edges) return c;
  if (c[0] > c[1]) std::swap(c[0], c[1]);
  return std::pair(c[0], c[1]) < std::pair(c[2], c[3]) ? c : Corners{c[2], c[3], c[0], c[1]};
}

struct Pairs {
  std::set<Corners> vertex_triangle, edge_edge;
};

/// Calls take(edges, corners, gap [m]) for all pairs that share no vertex and are nearer than `far` [m].
template <class Take>
void for_all_pairs(const model::Model& model, const std::vector<glm::vec3>& x, double far, const Take& take) {
  const auto visit = [&](bool edges, const Corners& corners) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        if (corners[i] == corners[j]) return;
    // How far the boxes around the two parts are apart along an axis: they are no nearer.
    const int parted = edges ? 2 : 1;
    for (int axis = 0; axis < 3; ++axis) {
      float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
      for (int k = 0; k < 4; ++k) {
        const float at = x[corners[k]][axis];
        low[k >= parted] = std::min(low[k >= parted], at);
        high[k >= parted] = std::max(high[k >= parted], at);
      }
      if (std::max(low[0] - high[1], low[1] - high[0]) > 1.001 * far) return;
    }
    elements::Corners places;
    for (int k = 0; k < 4; ++k) places.x[k] = glm::dvec3(x[corners[k]]) - glm::dvec3(x[corners[0]]);
    take(edges, corners, elements::separation(edges, places).gap);
  };
  for (std::uint32_t v = 0; v < model.vertex_count(); ++v)
    for (const auto& [a, b, c] : model.triangles) visit(false, {v, a, b, c});
  const auto edges = test::edges_of(model);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      visit(true, {edges[i].first, edges[i].second, edges[j].first, edges[j].second});
}

/// The search of a scene, without the steps that it is for.
struct Search {
  explicit Search(const scene::Scene& scene, const model::Model& model)
      : model_(model),
        dt_(static_cast<float>(scene.solver.dt)),
        state_(model, motions_),
        rest_position_(rest_of(model), GL_RGBA32F) {
    Result<sim::SurfacePairs> made =
        sim::SurfacePairs::create(model, sim::surface_triangles(model, sim::SurfaceBlocks::most_blocks));
    REQUIRE(made);
    pairs = std::move(*made);
    pairs.set_parameters(scene, model, 1);
    pairs.invalidate();
  }

  /// Moves the vertices to `place(vertex)`, at rest, and brings the pairs up to date.
  template <class Place>
  void update(const Place& place) {
    update(place, [](std::uint32_t) { return glm::vec3(0.0f); });
  }
  /// The same after a time step, at the velocities `velocity(vertex)`.
  template <class Place, class Velocity>
  void update(const Place& place, const Velocity& velocity) {
    sim::State state = state_.read();
    for (std::uint32_t i = 0; i < model_.vertex_count(); ++i) {
      state.position[i] = place(i);
      state.velocity[i] = velocity(i);
    }
    state_.write(state, model_, motions_);
    // What the end of a step counts (shaders/surface/begin.comp).
    const float since = control.since + dt_;
    glNamedBufferSubData(pairs.control().id(), offsetof(sim::SurfaceControl, since), sizeof since, &since);
    rest_position_.bind(unit_rest_position);
    sim::Pace pace;
    sim::Work work = pairs.update(state_);
    while (!work.done()) work.resume(pace);
    pairs.control().download(&control, sizeof control);
    position = state.position;
  }

  sim::SurfacePairs pairs;
  sim::SurfaceControl control;
  std::vector<glm::vec3> position;

 private:
  static gl::Buffer rest_of(const model::Model& model) {
    std::vector<glm::vec4> rest;
    for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
      rest.emplace_back(glm::vec3(model.rest_position[i]), static_cast<float>(model.vertex_cloth[i]));
    return gl::Buffer(rest);
  }

  const model::Model& model_;
  const float dt_;  // [s]
  const sim::MotionTable motions_;
  sim::StateBuffers state_;
  const gl::TextureBuffer rest_position_;
};

struct NearPairs {
  std::uint32_t count = 0, missing = 0;  ///< missing: not listed
};

/// The pairs that are near where a search has the vertices.
NearPairs near_pairs(const Search& search, const model::Model& model) {
  NearPairs found;
  Pairs listed;
  for (const sim::SurfacePairs::Pair& pair : search.pairs.read_pairs())
    (pair.edges ? listed.edge_edge : listed.vertex_triangle).insert(in_order(pair.edges, pair.corners));
  const double query = std::bit_cast<float>(search.control.query);
  const double flat_query = std::bit_cast<float>(search.control.flat_query);
  const double far = std::max(query, flat_query);
  for_all_pairs(model, search.position, far, [&](bool edges, const Corners& corners, double gap) {
    const bool one_cloth = model.vertex_cloth[corners[0]] == model.vertex_cloth[corners[3]];
    if (!(gap < (one_cloth ? flat_query : query))) return;
    ++found.count;
    found.missing += !(edges ? listed.edge_edge : listed.vertex_triangle).contains(in_order(edges, corners));
  });
  return found;
}

}  // namespace

TEST_CASE(
    "while no search is due, the pairs that the last one listed are all that are near, however surfaces "
    "move and whatever their velocities say") {
  const auto context = test::context();
  for (const double thickness : {0.002, 0.02}) {
    const scene::Scene scene = two_sheets(thickness);
    const auto simulation = test::simulation(scene);
    const model::Model& model = simulation->model();
    // Searches where the state's velocities are 0, the true ones, and wrong: slower ones of other vertices,
    // in the opposite direction.
    std::array<std::uint32_t, 3> searches{};
    for (const int told : {0, 1, 2}) {
      Search search(scene, model);
      constexpr std::uint32_t updates = 150;
      std::uint32_t near = 0, whole = 0;
      for (std::uint32_t update = 0; update < updates; ++update) {
        const auto place = [&](std::uint32_t i, double steps) {
          return moved(model.rest_position[i], model.vertex_cloth[i] == 1, 0.006 * steps);
        };
        const auto velocity = [&](std::uint32_t i) {
          return (place(i, update + 0.01) - place(i, update)) / (0.01f * static_cast<float>(scene.solver.dt));
        };
        search.update([&](std::uint32_t i) { return place(i, update); },
                      [&](std::uint32_t i) {
                        return told == 0   ? glm::vec3(0.0f)
                               : told == 1 ? velocity(i)
                                           : -0.2f * velocity((i + 1) % model.vertex_count());
                      });
        if (search.control.overflow != 0) continue;  // until the lists are longer, nothing may move
        ++whole;
        const NearPairs found = near_pairs(search, model);
        near += found.count;
        CHECK(found.missing == 0);
      }
      searches[told] = search.control.rebuilds;
      INFO("thickness " << thickness << ": " << searches[told] << " searches, " << near << " near");
      CHECK(searches[told] < updates);  // else nothing is tested
      CHECK(near > 1000);
      CHECK(whole > updates - 30);
    }
    INFO(searches[0] << ", " << searches[1] << ", " << searches[2] << " searches");
    CHECK(2 * searches[1] < searches[0]);  // a search looks ahead
  }
}

TEST_CASE("many pairs that stay near are listed anew with a narrower skin, which widens as they move again") {
  const auto context = test::context();
  scene::Scene scene = two_sheets(0.008);
  for (scene::Cloth& cloth : scene.cloths) cloth.mesh = scene::Grid{19, 19, size, size};
  scene.cloths[1].transform.translate.y = 0.006;
  const Result<model::Model> model = model::build(scene);
  Search search(scene, *model);
  // Waves that make a sheet slide to and fro over the other one by up to 2 cm.
  const auto slid = [&](std::uint32_t i, double phase) {
    const double way = model->vertex_cloth[i] == 0 ? 0.0 : 0.02 * std::sin(phase);
    return glm::vec3(model->rest_position[i] + glm::dvec3(way, 0.0, 0.0));
  };
  const auto at_rest = [&](std::uint32_t i) { return slid(i, 0.0); };
  for (int step = 0; step < 5; ++step) search.update(at_rest);  // lists grow
  const std::uint32_t many = search.control.pairs, searches = search.control.rebuilds;
  const float wide = search.control.skin;
  CHECK(many > 4096);
  for (int step = 0; step < 200; ++step) search.update(at_rest);
  // Lists that nothing made invalid were made anew: twice, as each may narrow the skin by a factor of four.
  CHECK(search.control.rebuilds == searches + 2);
  CHECK(search.control.skin < wide / 8);
  CHECK(search.control.pairs < many - many / 4);
  CHECK(near_pairs(search, *model).missing == 0);
  for (int step = 1; step <= 60; ++step) {
    search.update([&](std::uint32_t i) { return slid(i, 0.05 * step); });
    if (step % 20 == 10) CHECK(near_pairs(search, *model).missing == 0);
  }
  CHECK(search.control.skin > wide / 8);
}

TEST_CASE("surfaces that fall as one need no search, and one as soon as they fall differently") {
  const auto context = test::context();
  const scene::Scene scene = two_sheets(0.002);
  const auto simulation = test::simulation(scene);
  const model::Model& model = simulation->model();
  Search search(scene, model);
  const auto fallen = [&](std::uint32_t i, double way) {
    return glm::vec3(model.rest_position[i]) - glm::vec3(0.0f, way, 0.0f);
  };
  for (int update = 0; update < 20; ++update)  // lists grow
    search.update([&](std::uint32_t i) { return fallen(i, 0.0); });
  const std::uint32_t searches = search.control.rebuilds;
  for (int update = 0; update < 30; ++update)
    search.update([&](std::uint32_t i) { return fallen(i, 0.1 * update); });
  CHECK(search.control.rebuilds == searches);
  search.update([&](std::uint32_t i) { return fallen(i, model.vertex_cloth[i] == 1 ? 2.9 : 2.88); });
  // Two sheets that are nearer to each other have more pairs, and another search may follow, with longer
  // lists.
  CHECK(search.control.rebuilds > searches);
  CHECK(search.control.rebuilds <= searches + 2);
}

TEST_CASE("surfaces that go on as they went at the last search need none, and one soon after they stop") {
  const auto context = test::context();
  const scene::Scene scene = two_sheets(0.002);
  const auto simulation = test::simulation(scene);
  const model::Model& model = simulation->model();
  Search search(scene, model);
  // The upper sheet slides over the lower one, widens as it goes, and sinks: by 1 cm in ten steps.
  const auto velocity = [&](std::uint32_t i) {
    const auto x = glm::vec3(model.rest_position[i]);
    return model.vertex_cloth[i] == 1 ? glm::vec3(5.0f + 3.0f * x.x, -1.0f, 3.0f * x.z) : glm::vec3(0.0f);
  };
  const auto gone = [&](std::uint32_t i, double steps) {
    return glm::vec3(model.rest_position[i]) + velocity(i) * static_cast<float>(steps * scene.solver.dt);
  };
  // Slowly at first, so that the searches look farther and farther ahead.
  double steps = -40.0;
  for (; steps < 0.0; ++steps) search.update([&](std::uint32_t i) { return gone(i, steps); }, velocity);
  const std::uint32_t searches = search.control.rebuilds;
  CHECK(search.control.ahead >= 10.0f * static_cast<float>(scene.solver.dt));
  for (; steps < 10.0; ++steps) {
    search.update([&](std::uint32_t i) { return gone(i, steps); }, velocity);
    CHECK(near_pairs(search, model).missing == 0);
  }
  CHECK(search.control.rebuilds <= searches + 2);  // at 5 mm a step and a skin of 10 mm; a list may grow, too
  for (int waiting = 0; waiting < 10; ++waiting)
    search.update([&](std::uint32_t i) { return gone(i, steps); });
  CHECK(search.control.rebuilds > searches);
}

TEST_CASE("a block that turns about its own middle asks for a search before it meets another") {
  const auto context = test::context();
  scene::Scene scene = two_sheets(0.002);
  // One block each: 16 triangles, and farther apart at the start than they are wide.
  for (scene::Cloth& cloth : scene.cloths) cloth.mesh = scene::Grid{3, 5, size, size};
  scene.cloths[1].transform.translate.y = 1.0;
  const auto simulation = test::simulation(scene);
  const model::Model& model = simulation->model();
  Search search(scene, model);
  std::uint32_t near = 0;
  for (int update = 0; update < 120; ++update) {
    const double angle = 0.01 * update, c = std::cos(angle), s = std::sin(angle);
    search.update([&](std::uint32_t i) {
      const glm::dvec3 x(model.rest_position[i]);
      if (model.vertex_cloth[i] == 0) return glm::vec3(x.x, 0.0, x.z);
      const double along = x.x - model.rest_position[model.vertex_count() - 8].x;  // from the sheet's middle
      return glm::vec3(c * along, 0.08 + s * along, x.z);
    });
    const NearPairs found = near_pairs(search, model);
    near += found.count;
    CHECK(found.missing == 0);
  }
  CHECK(near > 0);
}
