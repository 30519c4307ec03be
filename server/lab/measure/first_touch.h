// When surfaces first touch that contact keeps apart: from then on the reference, which knows no contact
// between surfaces, is not the true motion.
#pragma once

#include <string>
#include <vector>

#include "server/model/crossings.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::lab {

class FirstTouch {
 public:
  /// Looks from the scene's start on. Both have to outlive it.
  FirstTouch(const scene::Scene& scene, const model::Model& model);

  /// Looks at the cloths' vertices [vertex_count] [m] at `time` [s], finite, and on the straight ways there
  /// from the last look. Returns what has touched, in words; empty: nothing has come as near as contact keeps
  /// it.
  std::string look(const std::vector<glm::dvec3>& position, double time);

 private:
  using Places = std::vector<glm::dvec3>;  ///< of the vertices of cloths and bodies [m]
  /// A pair of parts nearer than contact keeps it and `farther` [m] more, in words; empty: there is none.
  std::string near_pair(const Places& x, double farther) const;
  bool of_one_cloth(const std::array<std::uint32_t, 4>& corners) const;

  const scene::Scene& scene_;
  const model::Model& model_;
  model::Surfaces surfaces_;
  double thickness_ = 0;  ///< contact begins at this distance [m]; 0: the scene has no such contact
  Places last_;           ///< at the last look
};

}  // namespace clothlab::lab
