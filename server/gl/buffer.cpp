#include "server/gl/buffer.h"

#include <algorithm>
#include <new>

#include "server/gl/reads.h"
#include "shaders/slots.h"

namespace clothlab::gl {

namespace {
thread_local std::size_t held = 0;  // a buffer is freed where it was made: there its context is current
}

std::size_t buffer_bytes() {
  return held;
}

namespace {
thread_local std::size_t most_texels_of_thread = 0;

std::size_t bytes_of_texel(GLenum format) {
  return format == GL_R32UI ? 4 : format == GL_RG32UI ? 8 : 16;
}
}  // namespace

std::size_t most_texels() {
  return most_texels_of_thread;
}

Buffer::Buffer(std::size_t bytes, const void* data, GLbitfield flags) : bytes_(bytes) {
  glCreateBuffers(1, &id_);
  while (glGetError() == GL_OUT_OF_MEMORY) {
  }  // discards errors of earlier calls
  glNamedBufferStorage(id_, static_cast<GLsizeiptr>(bytes), data, flags);
  if (glGetError() == GL_OUT_OF_MEMORY) {
    glDeleteBuffers(1, &id_);
    throw std::bad_alloc();
  }
  held += bytes;
  if (!data && (flags & GL_MAP_PERSISTENT_BIT) == 0) fill(0);
}

Buffer::~Buffer() {
  if (!id_) return;
  glDeleteBuffers(1, &id_);
  held -= bytes_;
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

void Buffer::upload(const void* data, std::size_t bytes, std::size_t offset) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glNamedBufferSubData(id_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::download(void* data, std::size_t bytes, std::size_t offset) const {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(id_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::fill(std::uint32_t value) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void Buffer::copy_from(const Buffer& other) {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glCopyNamedBufferSubData(other.id_, id_, 0, 0, static_cast<GLsizeiptr>(std::min(bytes_, other.bytes_)));
}

BufferTexture::BufferTexture(const Buffer& buffer, GLenum format) {
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &id_);
  glTextureBuffer(id_, format, buffer.id());
  most_texels_of_thread = std::max(most_texels_of_thread, buffer.bytes() / bytes_of_texel(format));
}

BufferTexture::~BufferTexture() {
  if (id_) glDeleteTextures(1, &id_);
}

BufferTexture& BufferTexture::operator=(BufferTexture&& other) noexcept {
  std::swap(id_, other.id_);
  return *this;
}

void TextureBuffer::bind(GLuint unit) const {
  texture.bind(unit);
  if (fastest_reads() == Reads::storage) buffer.bind_storage(number_of_slots + unit);
}

ReadbackRing::ReadbackRing(std::size_t slot_bytes, int slots)
    : slot_bytes_(slot_bytes),
      slot_stride_((slot_bytes + 255) / 256 * 256),
      fences_(static_cast<std::size_t>(slots), nullptr),
      sizes_(static_cast<std::size_t>(slots), 0) {
  const std::size_t bytes = slot_stride_ * fences_.size();
  const GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  storage_ = Buffer(bytes, nullptr, flags);
  mapped_ = static_cast<const std::byte*>(
      glMapNamedBufferRange(storage_.id(), 0, static_cast<GLsizeiptr>(bytes), flags));
}

ReadbackRing::~ReadbackRing() {
  for (GLsync fence : fences_)
    if (fence) glDeleteSync(fence);
}

ReadbackRing& ReadbackRing::operator=(ReadbackRing&& other) noexcept {
  std::swap(storage_, other.storage_);
  std::swap(mapped_, other.mapped_);
  std::swap(slot_bytes_, other.slot_bytes_);
  std::swap(slot_stride_, other.slot_stride_);
  std::swap(fences_, other.fences_);
  std::swap(sizes_, other.sizes_);
  std::swap(first_, other.first_);
  std::swap(pending_, other.pending_);
  return *this;
}

void ReadbackRing::push(const Buffer& source, std::size_t bytes) {
  const std::size_t slot = (first_ + pending_) % fences_.size();
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glCopyNamedBufferSubData(source.id(), storage_.id(), 0, static_cast<GLintptr>(slot * slot_stride_),
                           static_cast<GLsizeiptr>(bytes));
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
  fences_[slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  sizes_[slot] = bytes;
  glFlush();
  ++pending_;
}

std::span<const std::byte> ReadbackRing::front(bool wait) {
  if (empty() || !mapped_) return {};
  constexpr GLuint64 one_second = 1'000'000'000;
  const GLenum state = glClientWaitSync(fences_[first_], GL_SYNC_FLUSH_COMMANDS_BIT, wait ? one_second : 0);
  if (state == GL_TIMEOUT_EXPIRED && wait) return front(true);
  if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) return {};
  return {mapped_ + first_ * slot_stride_, sizes_[first_]};
}

void ReadbackRing::pop() {
  glDeleteSync(fences_[first_]);
  fences_[first_] = nullptr;
  first_ = (first_ + 1) % fences_.size();
  --pending_;
}

}  // namespace clothlab::gl
