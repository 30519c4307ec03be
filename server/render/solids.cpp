#include "server/render/solids.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <variant>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/render/body_surface.h"
#include "server/scene/placement.h"
#include "server/scene/solid.h"
#include "shaders/slots.h"

namespace clothlab::render {

namespace {

/// A vertex as shaders/render/placed.glsl has it.
struct Vertex {
  glm::vec3 corner, direction;
};

/// The surface of everything within a radius of a line along x, in strips around it: a capsule; with a line
/// without length a sphere. The middle circle is there twice, once at each end of the line.
std::vector<std::vector<Vertex>> round_strips() {
  constexpr int half = 24, sectors = 96;
  const auto at = [](int circle, int sector) {
    const float end = circle <= half ? 1.0f : -1.0f;
    const float down =
        std::numbers::pi_v<float> * static_cast<float>(circle - (circle > half)) / (2.0f * half);
    const float around = 2 * std::numbers::pi_v<float> * static_cast<float>(sector) / sectors;
    const float out = std::sin(down);
    return Vertex{{end, 0, 0}, {std::cos(down), out * std::cos(around), out * std::sin(around)}};
  };
  std::vector<std::vector<Vertex>> strips;
  for (int circle = 0; circle <= 2 * half; ++circle) {
    std::vector<Vertex>& strip = strips.emplace_back();
    for (int sector = 0; sector <= sectors; ++sector) {
      strip.push_back(at(circle, sector));
      strip.push_back(at(circle + 1, sector));
    }
  }
  return strips;
}

/// The six faces of a cuboid.
std::vector<std::vector<Vertex>> face_strips() {
  std::vector<std::vector<Vertex>> strips;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      std::vector<Vertex>& strip = strips.emplace_back();
      glm::vec3 outwards(0.0f);
      outwards[axis] = side;
      for (int n = 0; n < 4; ++n) {
        glm::vec3 corner = outwards;
        corner[(axis + 1) % 3] = (n & 1) ? side : -side;
        corner[(axis + 2) % 3] = (n & 2) ? 1.0f : -1.0f;
        strip.push_back({corner, outwards});
      }
    }
  return strips;
}

/// A surface in triangle strips, which face outwards.
class Strips {
 public:
  explicit Strips(const std::vector<std::vector<Vertex>>& strips) {
    std::vector<Vertex> all;
    for (const std::vector<Vertex>& strip : strips) {
      first_.push_back(static_cast<GLint>(all.size()));
      count_.push_back(static_cast<GLsizei>(strip.size()));
      all.insert(all.end(), strip.begin(), strip.end());
    }
    vertices_ = gl::Buffer(all);
    glCreateVertexArrays(1, &array_);
    attribute(attribute_position, offsetof(Vertex, corner));
    attribute(attribute_normal, offsetof(Vertex, direction));
  }
  ~Strips() { glDeleteVertexArrays(1, &array_); }
  Strips(const Strips&) = delete;
  Strips& operator=(const Strips&) = delete;

  void draw() const {
    glBindVertexArray(array_);
    glMultiDrawArrays(GL_TRIANGLE_STRIP, first_.data(), count_.data(), static_cast<GLsizei>(first_.size()));
  }

 private:
  void attribute(GLuint index, std::size_t offset) const {
    glEnableVertexArrayAttrib(array_, index);
    glVertexArrayAttribFormat(array_, index, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(array_, index, vertices_.id(), static_cast<GLintptr>(offset), sizeof(Vertex));
    glVertexArrayAttribBinding(array_, index, index);
  }

  gl::Buffer vertices_;
  GLuint array_ = 0;
  std::vector<GLint> first_;
  std::vector<GLsizei> count_;
};

/// Where a body is: a shape that is everything within its radius of a core (shaders/elements/solid.glsl).
Solids::Place place_of(const scene::Shape& body) {
  const scene::Solid solid = scene::solid(body);
  Solids::Place place{solid.point, static_cast<float>(solid.radius), glm::mat3(1.0f), solid.extent};
  if (solid.second != scene::dvec3(0.0))
    place.axes = glm::dmat3(solid.direction, solid.second, glm::cross(solid.direction, solid.second));
  return place;
}

}  // namespace

struct Solids::Implementation {
  gl::Program body, plane;
  Strips round{round_strips()}, cuboid{face_strips()};
  mutable std::map<std::shared_ptr<const scene::TriangleMesh>, BodySurface> surfaces;  ///< drawn before
  GLuint empty_array = 0;

  Implementation() { glCreateVertexArrays(1, &empty_array); }
  ~Implementation() { glDeleteVertexArrays(1, &empty_array); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void draw(Layer layer, const scene::Sphere& shape) const { draw_body(layer, shape, round); }
  void draw(Layer layer, const scene::Capsule& shape) const { draw_body(layer, shape, round); }
  void draw(Layer layer, const scene::Box& shape) const { draw_body(layer, shape, cuboid); }

  /// A mesh may be turned inside out or be a sheet: both of its sides are drawn.
  void draw(Layer layer, const scene::Body& shape) const {
    if (layer == Layer::ground) return;
    if (layer == Layer::body) body.use();
    const auto& [translate, rotate, scale] = shape.transform;
    place({translate, 0.0f, scene::turn(rotate), glm::vec3(static_cast<float>(scale))});
    const GLboolean culls = glIsEnabled(GL_CULL_FACE);
    glDisable(GL_CULL_FACE);
    surfaces.try_emplace(shape.mesh, *shape.mesh).first->second.draw();
    if (culls) glEnable(GL_CULL_FACE);
  }

  /// A plane receives shadows, but casts none.
  void draw(Layer layer, const scene::Plane& shape) const {
    if (layer != Layer::ground) return;
    plane.use();
    glBindVertexArray(empty_array);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUniform3fv(uniform_point, 1, glm::value_ptr(glm::vec3(shape.point)));
    glUniform3fv(uniform_normal, 1, glm::value_ptr(glm::vec3(shape.normal)));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_BLEND);
  }

  void draw_body(Layer layer, const scene::Shape& shape, const Strips& surface) const {
    if (layer == Layer::ground) return;
    if (layer == Layer::body) body.use();
    place(place_of(shape));
    surface.draw();
  }
};

Solids::Solids() : implementation_(std::make_unique<Implementation>()) {}
Solids::~Solids() = default;

Status Solids::load() {
  for (auto [program, vertex, fragment] :
       {std::tuple{&implementation_->body, "render/body.vert", "render/body.frag"},
        {&implementation_->plane, "render/plane.vert", "render/plane.frag"}}) {
    Result<gl::Program> loaded = gl::Program::load({vertex, fragment});
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
  }
  return ok();
}

void Solids::draw(Layer layer, const std::vector<scene::Collider>& colliders) const {
  for (const scene::Collider& collider : colliders)
    std::visit([&](const auto& shape) { implementation_->draw(layer, shape); }, collider.shape);
}

void Solids::place(const Place& place) {
  glUniform4fv(uniform_placed, 1, glm::value_ptr(glm::vec4(place.middle, place.radius)));
  glUniformMatrix3fv(uniform_axes, 1, GL_FALSE, glm::value_ptr(place.axes));
  glUniform3fv(uniform_extent, 1, glm::value_ptr(place.extent));
}

}  // namespace clothlab::render
