// Makes the matrix of implicit Euler's coarse level: P^T F J F P, with J the matrix of a step
// (shaders/methods/implicit_euler.glsl), F the filter that takes off what colliders prevent, and P the modes
// of the patches (coarse_modes.h). F leaves out masses and bending: so no motion is without any.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/coarse_modes.h"
#include "server/sim/contact_term.h"
#include "server/sim/patch_matrix.h"

namespace clothlab::sim {

class CoarseMatrix {
 public:
  /// `patch_of`: for each vertex its patch's place in the dissection.
  CoarseMatrix(model::Dissection dissection, std::vector<std::uint32_t> patch_of);

  /// Takes over the elements' numbers, which may change, and which vertices are pinned.
  void set_parameters(const model::Model& model, const scene::Scene& scene);

  /// The time in the equations, in place of the scene's dt [s], of a method that has several; until
  /// `set_parameters`.
  void set_dt(double dt);

  const std::vector<Shares>& shares() const { return shares_; }  ///< [vertex]

  /// Makes the matrix at the places `position` [vertex] (w: inverse mass). `constraint` [vertex]: as in
  /// implicit_euler.glsl, or empty if nothing is in contact.
  void make(const std::vector<glm::vec4>& position, const std::vector<glm::vec4>& constraint);
  /// Adds what a vertex feels of another's motion, or of its own [kg], less what colliders prevent. Whoever
  /// adds it for one vertex must add the transposed for the other. Terms beside those of elements, as of
  /// contacts between cloths, can be added to a matrix made. Patches that no element joins may have no place
  /// in it (PatchMatrix::couples): between them nothing is added.
  void add(std::uint32_t vertex, std::uint32_t other, const glm::dmat3& part);
  /// Adds a pair of surfaces that press each other. Where it joins patches that have no place for that in the
  /// matrix, each has as much of its own as keeps the matrix definite.
  void add_pair(const PressingPair& pair);
  const PatchMatrix& matrix() const { return matrix_; }

 private:
  template <class Law>
  using Elements = std::vector<model::Element<Law>>;

  void add_bending(const Elements<elements::Bending>& pairs);
  bool touches(std::uint32_t vertex) const {
    return !constraint_.empty() && constraint_[vertex] != glm::vec4(0.0F);
  }
  void add_unfiltered(std::uint32_t vertex, std::uint32_t other, const glm::dmat3& part);
  template <class Law>
  void add_element(const model::Element<Law>& element, const std::vector<glm::vec4>& position);

  std::vector<std::uint32_t> patch_of_;
  std::vector<Shares> shares_;
  PatchMatrix empty_;  ///< with what stays: bending, whose matrix does not depend on places
  PatchMatrix matrix_;
  elements::PerLaw<Elements> elements_;  ///< those with a vertex that is not pinned
  Elements<elements::Bending> bending_;  ///< of a method that may `set_dt`; else left out, as `empty_` has it
  std::vector<glm::vec4> constraint_;    ///< of `make`
  double dt_ = 0, air_drag_ = 0;
};

}  // namespace clothlab::sim
