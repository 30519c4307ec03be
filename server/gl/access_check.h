// Whether what shaders write into buffers is read, or written again, behind the barriers that OpenGL 4.5 asks
// for (section 7.12.2 of its specification). Knows buffers by their names alone, and calls no OpenGL.
#pragma once

#include <glad/gl.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>

namespace clothlab::gl {

/// How a buffer is used. Shaders write through storage blocks alone.
enum class Access {
  storage_read,
  storage_write,
  texture,    ///< as a buffer texture
  uniform,    ///< as a uniform block
  command,    ///< arguments of an indirect dispatch
  attribute,  ///< of vertices
  element,    ///< indices of vertices
  read_back,  ///< a copy of it, or from it to the client
  update,     ///< a copy or an upload into it
  mapped,     ///< the client reads its memory, once a fence has passed
};

struct Use {
  GLuint buffer = 0;
  Access access = Access::storage_read;
  std::string place;  ///< who uses it and how, for people: "surface/limit.comp, storage block Limits"
};

class AccessCheck {
 public:
  /// Is told each fault: who wrote or read, who comes after it, and the barrier that is missing between them.
  using Told = std::function<void(const std::string& fault)>;
  explicit AccessCheck(Told told) : told_(std::move(told)) {}

  void barrier(GLbitfield bits);
  /// A command, and all that it uses at the same time.
  void command(std::span<const Use> uses);
  /// The buffer is deleted: its name may become another's.
  void forget(GLuint buffer) { buffers_.erase(buffer); }

 private:
  struct Event {
    std::uint64_t at = 0;  ///< 0: never
    std::string place;
  };
  /// The last of each is enough: a barrier behind it is behind those before it, too.
  struct Buffer {
    Event shader_wrote, shader_read;
  };
  static constexpr std::size_t bits_of_barriers = 32;

  void check(const Use& use, const Buffer& buffer);
  /// Whether a barrier of this kind has come since.
  bool passed(const Event& event, GLbitfield bit) const;

  Told told_;
  std::uint64_t now_ = 0;
  std::array<std::uint64_t, bits_of_barriers> last_barrier_{};
  std::map<GLuint, Buffer> buffers_;
};

}  // namespace clothlab::gl
