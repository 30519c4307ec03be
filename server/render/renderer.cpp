#include "server/render/renderer.h"

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/render/camera.h"
#include "server/render/cloth_mesh.h"
#include "server/render/outline.h"
#include "server/render/solids.h"
#include "server/render/target.h"
#include "shaders/slots.h"

namespace clothlab::render {

namespace {

const glm::vec3 to_light = glm::normalize(glm::vec3(-0.45f, 1.0f, 0.6f));

/// The uniform block of shaders/render/frame.glsl.
struct FrameBlock {
  glm::mat4 view_projection, light_view_projection;
  glm::vec4 eye, to_light, framed;
  std::int32_t clear = 0, padding[3] = {};
};

}  // namespace

struct Renderer::Implementation {
  gl::Program normals, cloth, depth, background;
  gl::Buffer frame_block{sizeof(FrameBlock)};
  ShadowMap shadow_map;
  Solids solids;
  GLuint empty_vertex_array = 0;

  Implementation() { glCreateVertexArrays(1, &empty_vertex_array); }
  ~Implementation() { glDeleteVertexArrays(1, &empty_vertex_array); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Status load_programs();
  void set_frame(const DrawnMoment& moment, float aspect);
  void draw_shadow_map(const ClothMesh& cloth_mesh, const std::vector<scene::Collider>& colliders);
  void draw_picture(const DrawnMoment& moment, const ClothMesh& cloth_mesh);
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
  if (status) status = solids.load();
  if (status) status = load(background, {"render/background.vert", "render/background.frag"});
  return status;
}

void Renderer::Implementation::set_frame(const DrawnMoment& moment, float aspect) {
  Box box;
  std::vector<Ball> all, subject;
  const auto add = [&](const Ball& ball, const std::string& of) {
    if (!std::isfinite(ball.center.x + ball.center.y + ball.center.z + ball.radius)) return;
    box.add(ball.center, ball.radius);
    all.push_back(ball);
    if (of == moment.subject) subject.push_back(ball);
  };
  for (std::size_t i = 0; i < moment.positions.size(); ++i)
    add({moment.positions[i], 0.0f}, moment.scene.cloths[moment.model.vertex_cloth[i]].name);
  for (const scene::Collider& collider : moment.colliders)
    for (const Ball& ball : outline(collider.shape)) add(ball, collider.name);
  const Camera camera = frame(subject.empty() ? all : subject, box, moment.view, aspect);
  const FrameBlock block{
      camera.view_projection, light_view_projection(box, to_light),  glm::vec4(camera.eye, 1),
      glm::vec4(to_light, 0), glm::vec4(box.center(), box.radius()), moment.clear};
  frame_block.upload(&block, sizeof block);
  glBindBufferBase(GL_UNIFORM_BUFFER, block_frame, frame_block.id());
}

void Renderer::Implementation::draw_shadow_map(const ClothMesh& cloth_mesh,
                                               const std::vector<scene::Collider>& colliders) {
  shadow_map.bind();
  glDisable(GL_CULL_FACE);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 2.0f);
  depth.use();
  solids.draw(Solids::Layer::shadow, colliders);
  Solids::place({});
  cloth_mesh.draw_plain();
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::Implementation::draw_picture(const DrawnMoment& moment, const ClothMesh& cloth_mesh) {
  shadow_map.bind_texture();
  if (!moment.clear) {
    glDisable(GL_DEPTH_TEST);
    background.use();
    glBindVertexArray(empty_vertex_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
  }
  glDepthMask(!moment.clear);  // a shadow alone hides nothing
  solids.draw(Solids::Layer::ground, moment.colliders);
  glDepthMask(GL_TRUE);
  glEnable(GL_CULL_FACE);
  solids.draw(Solids::Layer::body, moment.colliders);
  cloth.use();
  cloth_mesh.draw(moment.scene);
  glDisable(GL_CULL_FACE);
}

Renderer::Renderer() : implementation_(std::make_unique<Implementation>()) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create() {
  std::unique_ptr<Renderer> renderer(new Renderer);
  if (Status loaded = renderer->implementation_->load_programs(); !loaded) return loaded.error();
  return renderer;
}

Result<Image> Renderer::render(const DrawnMoment& moment, int width, int height) {
  if (Status size = check_size(width, height); !size) return size.error();
  Result<Target> target = Target::create(width, height);
  if (!target) return target.error();

  Implementation& self = *implementation_;
  self.set_frame(moment, static_cast<float>(width) / static_cast<float>(height));
  const ClothMesh cloth_mesh(moment.model, moment.positions, self.normals);
  glEnable(GL_DEPTH_TEST);
  self.draw_shadow_map(cloth_mesh, moment.colliders);
  target->bind();
  self.draw_picture(moment, cloth_mesh);
  Image image = target->read(moment.clear);

  // Leaves nothing of the drawing bound, because other work may follow in this context.
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindVertexArray(0);
  glUseProgram(0);
  return image;
}

}  // namespace clothlab::render
