#include "server/render/solids.h"

#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vec4.hpp>
#include <numbers>
#include <tuple>
#include <utility>
#include <variant>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "shaders/slots.h"

namespace clothlab::render {

namespace {

constexpr int bands = 48, sectors = 96, strip_length = 2 * (sectors + 1);

/// The unit sphere as a triangle strip around each band of latitude.
std::vector<glm::vec3> unit_sphere() {
  std::vector<glm::vec3> all;
  const auto at = [](int band, int sector) {
    const float down = std::numbers::pi_v<float> * static_cast<float>(band) / bands;
    const float around = 2 * std::numbers::pi_v<float> * static_cast<float>(sector) / sectors;
    return glm::vec3(std::sin(down) * std::sin(around), std::cos(down), std::sin(down) * std::cos(around));
  };
  for (int band = 0; band < bands; ++band)
    for (int sector = 0; sector <= sectors; ++sector) {
      all.push_back(at(band, sector));
      all.push_back(at(band + 1, sector));
    }
  return all;
}

}  // namespace

struct Solids::Implementation {
  gl::Program sphere, plane;
  gl::Buffer sphere_points{unit_sphere()};
  GLuint sphere_array = 0, empty_array = 0;

  Implementation() {
    glCreateVertexArrays(1, &empty_array);
    glCreateVertexArrays(1, &sphere_array);
    glEnableVertexArrayAttrib(sphere_array, attribute_position);
    glVertexArrayAttribFormat(sphere_array, attribute_position, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(sphere_array, attribute_position, sphere_points.id(), 0, sizeof(glm::vec3));
    glVertexArrayAttribBinding(sphere_array, attribute_position, attribute_position);
  }
  ~Implementation() {
    glDeleteVertexArrays(1, &sphere_array);
    glDeleteVertexArrays(1, &empty_array);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void draw(Layer layer, const scene::Sphere& shape) const {
    if (layer == Layer::ground) return;
    if (layer == Layer::body) sphere.use();
    glBindVertexArray(sphere_array);
    const glm::vec4 placed(glm::vec3(shape.center), static_cast<float>(shape.radius));
    glUniform4fv(uniform_placed, 1, glm::value_ptr(placed));
    for (int band = 0; band < bands; ++band)
      glDrawArrays(GL_TRIANGLE_STRIP, band * strip_length, strip_length);
  }

  /// A plane receives shadows, but casts none.
  void draw(Layer layer, const scene::Plane& shape) const {
    if (layer != Layer::ground) return;
    plane.use();
    glBindVertexArray(empty_array);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glUniform3fv(uniform_point, 1, glm::value_ptr(glm::vec3(shape.point)));
    glUniform3fv(uniform_normal, 1, glm::value_ptr(glm::vec3(shape.normal)));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_BLEND);
  }
};

Solids::Solids() : implementation_(std::make_unique<Implementation>()) {}
Solids::~Solids() = default;

Status Solids::load() {
  for (auto [program, vertex, fragment] :
       {std::tuple{&implementation_->sphere, "render/sphere.vert", "render/sphere.frag"},
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

}  // namespace clothlab::render
