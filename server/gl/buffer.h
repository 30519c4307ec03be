// Classes that own GL objects and delete them: buffers, buffer textures, and a ring of buffers that brings
// results back without waiting for the GPU.
#pragma once

#include <glad/gl.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace clothlab::gl {

/// A buffer of fixed size in GPU memory.
class Buffer {
 public:
  Buffer() = default;
  /// `flags` are those of glNamedBufferStorage; `upload` needs GL_DYNAMIC_STORAGE_BIT. Throws std::bad_alloc
  /// if the device has too little memory.
  explicit Buffer(std::size_t bytes, const void* data = nullptr, GLbitfield flags = GL_DYNAMIC_STORAGE_BIT);
  template <class T>
  explicit Buffer(const std::vector<T>& items)
      : Buffer(items.empty() ? 16 : items.size() * sizeof(T), items.empty() ? nullptr : items.data()) {}
  ~Buffer();
  Buffer(Buffer&& other) noexcept { *this = std::move(other); }
  Buffer& operator=(Buffer&& other) noexcept;

  GLuint id() const { return id_; }
  std::size_t bytes() const { return bytes_; }
  // These see all that shaders have written before, and what they write themselves needs no barrier.
  void upload(const void* data, std::size_t bytes, std::size_t offset = 0);
  /// Copies bytes from the buffer to `data`; waits for the GPU.
  void download(void* data, std::size_t bytes, std::size_t offset = 0) const;
  void fill(std::uint32_t value);
  /// Queues a copy of `other`, or of as much of it as there is room for.
  void copy_from(const Buffer& other);
  void bind_storage(GLuint binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_); }
  void bind_uniform(GLuint binding) const { glBindBufferBase(GL_UNIFORM_BUFFER, binding, id_); }

 private:
  GLuint id_ = 0;
  std::size_t bytes_ = 0;
};

/// Bytes of all buffers that the calling thread has made and not freed: what its scene takes of the device's
/// memory, or of the machine's where that computes.
std::size_t buffer_bytes();

/// Texels of the largest buffer texture that the calling thread has made: what its scenes need of
/// GL_MAX_TEXTURE_BUFFER_SIZE.
std::size_t most_texels();

/// A texture view of a buffer. On software OpenGL kernels read it much faster than a storage buffer
/// (shaders/access.glsl).
class BufferTexture {
 public:
  BufferTexture() = default;
  BufferTexture(const Buffer& buffer, GLenum format);
  ~BufferTexture();
  BufferTexture(BufferTexture&& other) noexcept { *this = std::move(other); }
  BufferTexture& operator=(BufferTexture&& other) noexcept;
  void bind(GLuint unit) const { glBindTextureUnit(unit, id_); }

 private:
  GLuint id_ = 0;
};

/// A buffer that kernels read through shaders/access.glsl, and that other kernels may write.
struct TextureBuffer {
  Buffer buffer;
  BufferTexture texture;
  TextureBuffer() = default;
  TextureBuffer(Buffer storage, GLenum format) : buffer(std::move(storage)), texture(buffer, format) {}
  /// Binds the buffer where kernels read it as READ_...(name, unit).
  void bind(GLuint unit) const;
};

/// A ring of slots for copies of GPU results: `push` queues a copy, and `front` reads that copy once its
/// fence says that it has arrived.
class ReadbackRing {
 public:
  ReadbackRing() = default;
  ReadbackRing(std::size_t slot_bytes, int slots);
  ~ReadbackRing();
  ReadbackRing(ReadbackRing&& other) noexcept { *this = std::move(other); }
  ReadbackRing& operator=(ReadbackRing&& other) noexcept;

  std::size_t slot_bytes() const { return slot_bytes_; }
  bool full() const { return pending_ == fences_.size(); }
  bool empty() const { return pending_ == 0; }
  /// Queues a copy of `source` [0, bytes) after the work queued so far. The ring must not be full.
  void push(const Buffer& source, std::size_t bytes);
  /// The oldest copy; empty if there is none or, without `wait`, if it has not arrived. Valid until `pop`.
  std::span<const std::byte> front(bool wait);
  void pop();

 private:
  Buffer storage_;
  const std::byte* mapped_ = nullptr;
  std::size_t slot_bytes_ = 0, slot_stride_ = 0;
  std::vector<GLsync> fences_;
  std::vector<std::size_t> sizes_;
  std::size_t first_ = 0, pending_ = 0;
};

}  // namespace clothlab::gl
