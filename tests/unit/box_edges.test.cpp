// Boxes at rest among surfaces: their corners and edges are part of the model, beside the solid that they
// are.
#include <algorithm>
#include <glm/geometric.hpp>
#include <set>

#include "server/model/bodies.h"
#include "server/sim/colliders.h"
#include "server/sim/plan.h"
#include "server/sim/surface_blocks.h"
#include "server/sim/surface_triangles.h"
#include "tests/body_meshes.h"
#include "tests/scenes.h"

using namespace clothlab;
using glm::dvec3;

namespace {

/// A sheet above a turned box, between surfaces.
scene::Scene above_box() {
  scene::Scene scene = test::sheet(5, 5);
  scene::Box box;
  box.center = {0.1, -2.0, 0.3};
  box.half = {0.5, 0.1, 0.2};
  box.axes = glm::dmat3(dvec3(0.6, 0.8, 0.0), dvec3(-0.8, 0.6, 0.0), dvec3(0.0, 0.0, 1.0));
  scene.colliders = {{"floor", scene::Plane{{0.0, -9.0, 0.0}}, 0.3, 0.0, {}}, {"box", box, 0.3, 0.0, {}}};
  scene.self_collision = scene::SelfCollision{0.01, 0.2};
  scene.self_collision->kind = scene::ContactKind::surface;
  return scene;
}

}  // namespace

TEST_CASE("a box has corners and edges in the model if it rests, among surfaces") {
  scene::Scene scene = above_box();
  const scene::Box box = std::get<scene::Box>(scene.colliders[1].shape);
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  REQUIRE(model->bodies.size() == 1);
  CHECK(model->bodies[0].box);
  CHECK(model->bodies[0].collider == 1);
  REQUIRE(model->body_position.size() == 8);
  for (const dvec3& corner : model->body_position) {
    const dvec3 along = glm::transpose(box.axes) * (corner - box.center);
    for (int axis = 0; axis < 3; ++axis)
      CHECK(std::abs(along[axis]) == Approx(box.half[axis]).epsilon(1e-14));
  }
  // Its faces close, and face outwards: the volume of 12 tetrahedra is the box's.
  CHECK(model::BodyInside(*model, 0, model->body_position).contains(box.center));
  double volume = 0.0;
  for (const auto& [a, b, c] : model->body_triangles) {
    const std::uint32_t first = model->vertex_count();
    const dvec3 p = model->body_position[a - first] - box.center,
                q = model->body_position[b - first] - box.center,
                r = model->body_position[c - first] - box.center;
    volume += glm::dot(p, glm::cross(q, r)) / 6.0;
  }
  CHECK(volume == Approx(8.0 * box.half.x * box.half.y * box.half.z).epsilon(1e-12));
  CHECK(sim::contact_margin(scene, *model, 0, scene.colliders[1]) == sim::contact_margin(scene, *model, 0));

  scene.colliders[1].motion = scene::Linear{};
  CHECK(model::build(scene)->bodies.empty());
  CHECK(sim::contact_margin(scene, *model, 0, scene.colliders[1]) > sim::contact_margin(scene, *model, 0));
  scene = above_box();
  scene.self_collision->kind = scene::ContactKind::points;
  CHECK(model::build(scene)->bodies.empty());
}

TEST_CASE("of a box the pair search has eight corners and twelve edges, and one block") {
  const scene::Scene scene = above_box();
  const model::Model model = *model::build(scene);
  const sim::SurfaceTriangles surface = sim::surface_triangles(model, sim::SurfaceBlocks::most_blocks);
  CHECK(surface.triangles.size() == surface.cloth_triangle_count + 12);
  std::set<std::uint32_t> corners;
  std::size_t edges = 0;
  for (std::size_t i = surface.cloth_triangle_count; i < surface.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t tag = surface.triangles[i][k];
      if (tag >> 31) CHECK(corners.insert(sim::SurfaceTriangles::number_of(tag)).second);
      if (!(tag >> 30 & 1)) continue;
      ++edges;
      const dvec3 along =
          model.body_position[sim::SurfaceTriangles::number_of(tag) - model.vertex_count()] -
          model.body_position[sim::SurfaceTriangles::number_of(surface.triangles[i][(k + 1) % 3]) -
                              model.vertex_count()];
      const double length = glm::length(along);  // no diagonal
      CHECK((length == Approx(1.0) || length == Approx(0.2) || length == Approx(0.4)));
    }
  CHECK(corners.size() == 8);
  CHECK(edges == 12);
  CHECK(surface.blocks.size() == surface.cloth_block_count + 1);
  CHECK(surface.body_places.size() == 8);
}

TEST_CASE("boxes take no blocks of a mesh's, and a scene may have as many as it may have colliders") {
  scene::Scene scene = above_box();
  scene.colliders.push_back(test::body_of(test::ball_mesh(4), {{0.0, -6.0, 0.0}, {}, 1.0}));
  const auto blocks_of_mesh = [&] {
    const model::Model model = *model::build(scene);
    const sim::SurfaceTriangles surface = sim::surface_triangles(model, sim::SurfaceBlocks::most_blocks);
    const auto boxes =
        std::count_if(model.bodies.begin(), model.bodies.end(), [](const auto& of) { return of.box; });
    CHECK(surface.blocks.size() <= sim::SurfaceBlocks::most_blocks);
    return surface.blocks.size() - surface.cloth_block_count - static_cast<std::size_t>(boxes);
  };
  const std::size_t beside_one = blocks_of_mesh();
  while (scene.colliders.size() < 64) scene.colliders.push_back(scene.colliders[1]);
  CHECK(blocks_of_mesh() == beside_one);
}

TEST_CASE("cloth may start across a box, which pushes it out, and a box may be put elsewhere") {
  scene::Scene scene = above_box();
  std::get<scene::Box>(scene.colliders[1].shape).center = scene.cloths[0].transform.translate;
  CHECK(model::build(scene));
  const scene::Scene there = above_box();
  CHECK(sim::change_depth(scene, there) == sim::ChangeDepth::uniform);
  scene.colliders[1].motion = scene::Linear{};
  CHECK(sim::change_depth(scene, there) == sim::ChangeDepth::kernel);
}
