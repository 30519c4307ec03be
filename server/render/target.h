// Where the renderer draws: an anti-aliased framebuffer that becomes an Image, and the shadow map.
#pragma once

#include <glad/gl.h>

#include "server/base/result.h"
#include "server/render/image.h"
#include "shaders/slots.h"

namespace clothlab::render {

/// A colour and depth framebuffer with several samples a pixel.
class Target {
 public:
  static Result<Target> create(int width, int height);
  ~Target();
  Target(Target&& other) noexcept;
  Target& operator=(Target&&) = delete;

  /// Clears the depths, and the colours to transparent black; draws go here until another framebuffer is
  /// bound.
  void bind() const;
  /// Averages the samples and reads the picture back; with `clear` with its opacity. Draws blend colours that
  /// are multiplied by it.
  Image read(bool clear) const;

 private:
  Target(int width, int height);
  int width_, height_;
  GLuint samples_framebuffer_ = 0, resolved_framebuffer_ = 0;
  GLuint renderbuffers_[3] = {};  // samples' colour, samples' depth, resolved colour
};

/// The depths seen from the light, as a texture that the shaders read to find what is in shadow.
class ShadowMap {
 public:
  ShadowMap();
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  /// Clears the map; draws go here until another framebuffer is bound.
  void bind() const;
  void bind_texture() const { glBindTextureUnit(unit_shadow_map, texture_); }

 private:
  GLuint framebuffer_ = 0, texture_ = 0;
};

}  // namespace clothlab::render
