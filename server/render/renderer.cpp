#include "server/render/renderer.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vec4.hpp>
#include <numbers>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/render/camera.h"
#include "server/render/cloth_mesh.h"
#include "server/render/target.h"

namespace clothlab::render {

namespace {

const glm::vec3 to_light = glm::normalize(glm::vec3(-0.45f, 1.0f, 0.6f));

/// The uniform block of shaders/render/frame.glsl.
struct FrameBlock {
  glm::mat4 view_projection, light_view_projection;
  glm::vec4 eye, to_light, framed;
};

/// The unit sphere as a triangle strip around each band of latitude.
class SphereMesh {
 public:
  SphereMesh() : points_(points()) {
    glCreateVertexArrays(1, &vertex_array_);
    glEnableVertexArrayAttrib(vertex_array_, 0);
    glVertexArrayAttribFormat(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(vertex_array_, 0, points_.id(), 0, sizeof(glm::vec3));
    glVertexArrayAttribBinding(vertex_array_, 0, 0);
  }
  ~SphereMesh() { glDeleteVertexArrays(1, &vertex_array_); }
  SphereMesh(const SphereMesh&) = delete;
  SphereMesh& operator=(const SphereMesh&) = delete;

  /// Every sphere among the colliders; `placed` is uniform 0 of the program in use.
  void draw(const std::vector<scene::Collider>& colliders) const {
    glBindVertexArray(vertex_array_);
    for (const scene::Collider& collider : colliders) {
      const auto* sphere = std::get_if<scene::Sphere>(&collider.shape);
      if (!sphere) continue;
      const glm::vec4 placed(glm::vec3(sphere->center), static_cast<float>(sphere->radius));
      glUniform4fv(0, 1, glm::value_ptr(placed));
      for (int band = 0; band < bands; ++band)
        glDrawArrays(GL_TRIANGLE_STRIP, band * strip_length, strip_length);
    }
  }

 private:
  static constexpr int bands = 48, sectors = 96, strip_length = 2 * (sectors + 1);

  static std::vector<glm::vec3> points() {
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

  gl::Buffer points_;
  GLuint vertex_array_ = 0;
};

}  // namespace

struct Renderer::Implementation {
  gl::Program normals, cloth, depth, sphere, plane, background;
  gl::Buffer frame_block{sizeof(FrameBlock)};
  ShadowMap shadow_map;
  SphereMesh sphere_mesh;
  GLuint empty_vertex_array = 0;

  Implementation() { glCreateVertexArrays(1, &empty_vertex_array); }
  ~Implementation() { glDeleteVertexArrays(1, &empty_vertex_array); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Status load_programs();
  void set_frame(const Subject& subject, float aspect);
  void draw_shadow_map(const ClothMesh& cloth_mesh, const std::vector<scene::Collider>& colliders);
  void draw_picture(const Subject& subject, const ClothMesh& cloth_mesh);
  void draw_planes(const std::vector<scene::Collider>& colliders);
};

Status Renderer::Implementation::load_programs() {
  const auto load = [](gl::Program& program, std::initializer_list<std::string> paths) -> Status {
    Result<gl::Program> loaded = gl::Program::load(paths);
    if (!loaded) return loaded.error();
    program = std::move(*loaded);
    return ok();
  };
  Status status = load(normals, {"render/normals.comp"});
  if (status) status = load(cloth, {"render/cloth.vert", "render/cloth.geom", "render/cloth.frag"});
  if (status) status = load(depth, {"render/depth.vert", "render/depth.frag"});
  if (status) status = load(sphere, {"render/sphere.vert", "render/sphere.frag"});
  if (status) status = load(plane, {"render/plane.vert", "render/plane.frag"});
  if (status) status = load(background, {"render/background.vert", "render/background.frag"});
  return status;
}

void Renderer::Implementation::set_frame(const Subject& subject, float aspect) {
  Box box;
  for (const glm::vec3& position : subject.positions) box.add(position);
  for (const scene::Collider& collider : subject.colliders)
    if (const auto* sphere = std::get_if<scene::Sphere>(&collider.shape))
      box.add(glm::vec3(sphere->center), static_cast<float>(sphere->radius));
  const Camera camera = frame(box, aspect);
  const FrameBlock block{camera.view_projection, light_view_projection(box, to_light),
                         glm::vec4(camera.eye, 1), glm::vec4(to_light, 0),
                         glm::vec4(box.center(), box.radius())};
  frame_block.upload(&block, sizeof block);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_block.id());
}

void Renderer::Implementation::draw_shadow_map(const ClothMesh& cloth_mesh,
                                               const std::vector<scene::Collider>& colliders) {
  shadow_map.bind();
  glDisable(GL_CULL_FACE);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2.0f);
  depth.use();
  sphere_mesh.draw(colliders);
  glUniform4f(0, 0, 0, 0, 1);
  cloth_mesh.draw_plain();
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::Implementation::draw_planes(const std::vector<scene::Collider>& colliders) {
  plane.use();
  glBindVertexArray(empty_vertex_array);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (const scene::Collider& collider : colliders) {
    const auto* shape = std::get_if<scene::Plane>(&collider.shape);
    if (!shape) continue;
    glUniform3fv(0, 1, glm::value_ptr(glm::vec3(shape->point)));
    glUniform3fv(1, 1, glm::value_ptr(glm::vec3(shape->normal)));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  glDisable(GL_BLEND);
}

void Renderer::Implementation::draw_picture(const Subject& subject, const ClothMesh& cloth_mesh) {
  shadow_map.bind_texture();
  glDisable(GL_DEPTH_TEST);
  background.use();
  glBindVertexArray(empty_vertex_array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  draw_planes(subject.colliders);
  glEnable(GL_CULL_FACE);
  sphere.use();
  sphere_mesh.draw(subject.colliders);
  cloth.use();
  cloth_mesh.draw(subject.scene);
  glDisable(GL_CULL_FACE);
}

Renderer::Renderer() : implementation_(std::make_unique<Implementation>()) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create() {
  std::unique_ptr<Renderer> renderer(new Renderer);
  if (Status loaded = renderer->implementation_->load_programs(); !loaded) return loaded.error();
  return renderer;
}

Result<Image> Renderer::render(const Subject& subject, int width, int height) {
  if (Status size = check_size(width, height); !size) return size.error();
  Result<Target> target = Target::create(width, height);
  if (!target) return target.error();

  Implementation& self = *implementation_;
  self.set_frame(subject, static_cast<float>(width) / static_cast<float>(height));
  const ClothMesh cloth_mesh(subject.model, subject.positions, self.normals);
  glEnable(GL_DEPTH_TEST);
  self.draw_shadow_map(cloth_mesh, subject.colliders);
  target->bind();
  self.draw_picture(subject, cloth_mesh);
  Image image = target->read();

  // Nothing of this is left bound for who else computes in this context.
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindVertexArray(0);
  glUseProgram(0);
  return image;
}

}  // namespace clothlab::render
