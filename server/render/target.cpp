#include "server/render/target.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace clothlab::render {

namespace {
constexpr GLint wanted_samples = 8;
constexpr GLint most_total_samples =
    32 * 1024 * 1024;                  // 8 bytes each; larger pictures get fewer samples a pixel
constexpr GLsizei shadow_side = 2048;  // [pixels]

bool complete(GLuint framebuffer) {
  return glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

/// From colours that are multiplied by their opacity to those of a PNG, which are not.
void divide_by_opacity(std::vector<std::uint8_t>& rgba) {
  for (std::size_t at = 0; at < rgba.size(); at += 4)
    if (const int opacity = rgba[at + 3]; opacity > 0 && opacity < 255)
      for (std::size_t part = at; part < at + 3; ++part)
        rgba[part] = static_cast<std::uint8_t>(std::min((255 * rgba[part] + opacity / 2) / opacity, 255));
}
}  // namespace

Target::Target(int width, int height) : width_(width), height_(height) {
  GLint most_samples = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
  const GLint affordable = std::max(most_total_samples / (width * height), 1);
  const GLint samples = std::min({wanted_samples, most_samples, affordable});
  glCreateRenderbuffers(3, renderbuffers_);
  glNamedRenderbufferStorageMultisample(renderbuffers_[0], samples, GL_RGBA8, width, height);
  glNamedRenderbufferStorageMultisample(renderbuffers_[1], samples, GL_DEPTH_COMPONENT32F, width, height);
  glNamedRenderbufferStorage(renderbuffers_[2], GL_RGBA8, width, height);
  glCreateFramebuffers(1, &samples_framebuffer_);
  glNamedFramebufferRenderbuffer(samples_framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                 renderbuffers_[0]);
  glNamedFramebufferRenderbuffer(samples_framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                 renderbuffers_[1]);
  glCreateFramebuffers(1, &resolved_framebuffer_);
  glNamedFramebufferRenderbuffer(resolved_framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                 renderbuffers_[2]);
}

Result<Target> Target::create(int width, int height) {
  Target target(width, height);
  if (complete(target.samples_framebuffer_) && complete(target.resolved_framebuffer_)) return target;
  return Error{"render",
               "no framebuffer of " + std::to_string(width) + "x" + std::to_string(height) + " pixels",
               "the GPU may have too little memory: try a smaller size"};
}

Target::Target(Target&& other) noexcept
    : width_(other.width_),
      height_(other.height_),
      samples_framebuffer_(std::exchange(other.samples_framebuffer_, 0)),
      resolved_framebuffer_(std::exchange(other.resolved_framebuffer_, 0)) {
  std::swap(renderbuffers_, other.renderbuffers_);
}

Target::~Target() {
  glDeleteFramebuffers(1, &samples_framebuffer_);
  glDeleteFramebuffers(1, &resolved_framebuffer_);
  glDeleteRenderbuffers(3, renderbuffers_);
}

void Target::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, samples_framebuffer_);
  glViewport(0, 0, width_, height_);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

Image Target::read(bool clear) const {
  glBlitNamedFramebuffer(samples_framebuffer_, resolved_framebuffer_, 0, 0, width_, height_, 0, 0, width_,
                         height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  Image image{width_, height_, {}, clear ? 4 : 3};
  const std::size_t row = static_cast<std::size_t>(image.channels) * static_cast<std::size_t>(width_);
  image.pixels.resize(row * static_cast<std::size_t>(height_));
  glReadPixels(0, 0, width_, height_, clear ? GL_RGBA : GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
  if (clear) divide_by_opacity(image.pixels);
  // OpenGL's first row is the bottom one.
  for (auto top = image.pixels.begin(), bottom = image.pixels.end();
       bottom - top >= 2 * static_cast<std::ptrdiff_t>(row); top += static_cast<std::ptrdiff_t>(row)) {
    bottom -= static_cast<std::ptrdiff_t>(row);
    std::swap_ranges(top, top + static_cast<std::ptrdiff_t>(row), bottom);
  }
  return image;
}

ShadowMap::ShadowMap() {
  glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
  glTextureStorage2D(texture_, 1, GL_DEPTH_COMPONENT24, shadow_side, shadow_side);
  glTextureParameteri(texture_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(texture_, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  // The border is farther than everything, so that everything outside the map is lit.
  glTextureParameteri(texture_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTextureParameteri(texture_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const GLfloat farthest[4] = {1, 1, 1, 1};
  glTextureParameterfv(texture_, GL_TEXTURE_BORDER_COLOR, farthest);
  glCreateFramebuffers(1, &framebuffer_);
  glNamedFramebufferTexture(framebuffer_, GL_DEPTH_ATTACHMENT, texture_, 0);
  glNamedFramebufferDrawBuffer(framebuffer_, GL_NONE);
}

ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

void ShadowMap::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, shadow_side, shadow_side);
  glClear(GL_DEPTH_BUFFER_BIT);
}

}  // namespace clothlab::render
