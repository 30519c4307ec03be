// The coarse level of implicit Euler's preconditioner: the cloth as patches that move as a whole, and are
// stretched, sheared and turned along two axes (coarse_modes.h). Block Jacobi alone passes news on from
// vertex to vertex, one an iteration; the coarse level passes them on from patch to patch at once, and stiff
// cloth hinders no patch from turning. Two-level additive Schwarz: Nicolaides 1987; Toselli & Widlund 2005,
// chapter 3. For cloth: Wu, Wang & Wang 2022.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/contact_term.h"

namespace clothlab::sim {

/// What the matrix is at a vertex, as the kernels of implicit Euler have it.
struct FineLevel {
  const gl::TextureBuffer &position, &constraint;
  std::vector<PressingPair> pressing{};  ///< pairs of surfaces in the matrix
};

class CoarseLevel {
 public:
  /// The number of threads that shaders/methods/implicit_step.comp has for them.
  static constexpr std::uint32_t most_patches = 128;

  /// Divides the vertices into patches, which stay.
  explicit CoarseLevel(const model::Model& model);
  ~CoarseLevel();
  CoarseLevel(CoarseLevel&&) noexcept;
  CoarseLevel& operator=(CoarseLevel&&) noexcept;

  /// Tells a kernel where the lists are, for shaders/methods/implicit_patches.glsl.
  void set_lists(const gl::Program& program) const;

  /// Takes over the elements' numbers, which may change.
  void set_parameters(const model::Model& model, const scene::Scene& scene);
  /// As of CoarseMatrix.
  void set_dt(double dt);

  /// Makes the matrix of the patches at the present estimate, and the inverse of its factor. Waits for the
  /// GPU. `contacts`: whether anything may be in contact with a collider.
  void prepare(const FineLevel& fine, bool contacts);

  /// Binds all that the kernels of a solve read, and where they write the sums over patches.
  void bind() const;
  /// Binds where implicit_step.comp writes.
  void bind_vectors() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace clothlab::sim
