// The parts of a scene that can be left out, made coarser or replaced by a simpler model, each as a change of
// the scene document.
#pragma once

#include <string>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

/// What a part belongs to: of two changes of one thing, only one can be taken. Of others all can.
enum class PartOf { nothing, mesh, model, contact };

struct Part {
  std::string name;  ///< of the changed scene: "without bend springs", "half the mesh resolution"
  PartOf of = PartOf::nothing;
  int coarser = 1;  ///< the mesh resolution is divided by this factor; 1: the mesh stays as it is
  /// Of a simpler model of the cloth, or of its contact: both verdicts, "Springs suffice" and "Springs do not
  /// suffice". Empty: the part is left out or made coarser.
  std::string suffices, falls_short;
  /// True if the step becomes the same share of the changed scene's limit.
  bool own_step = false;
  /// Returns the document without the part. Error: why there is nothing to leave out; its `where` may be
  /// empty.
  Result<scene::Document> (*without)(const scene::Document&);
};

inline constexpr const char* without_damping = "without damping";

/// The parts that a scene may have, in the order in which they are listed to a user. Only scenes with a cloth
/// of finite elements have simpler models of it, and only those whose surfaces keep apart a simpler contact.
std::vector<Part> parts(const scene::Document& document);

/// The merge patch (RFC 7396) that turns `from` into `to`.
scene::json merge_patch(const scene::json& from, const scene::json& to);

}  // namespace clothlab::lab
