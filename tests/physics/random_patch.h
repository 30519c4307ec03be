// Random patches of a scene that are valid by construction. Each is drawn for the present document, with
// numbers from the ranges of server/scene/ranges.h: mostly usual ones, sometimes the very ends. Grids and
// iterations are kept small, so that many patches are tried in little time.
#pragma once

#include <cstdint>
#include <random>

#include "server/scene/document.h"
#include "server/scene/ranges.h"

namespace clothlab::test {

class RandomPatch {
 public:
  explicit RandomPatch(std::uint64_t seed) : random_(seed) {}

  /// A small scene to begin with.
  scene::json first_scene();
  /// A merge patch, or the operations that do the same; the document accepts it always.
  scene::json next(const scene::Document& document);
  /// An integer in [least, most].
  int whole(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }

 private:
  using json = scene::json;

  bool chance(double share) { return std::uniform_real_distribution<double>(0, 1)(random_) < share; }
  double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  /// A number in [least, most], evenly distributed in the logarithm.
  double spread(double least, double most);
  /// A number usually in [least, most], else anywhere in the range or at one of its ends.
  double usual(double least, double most, const scene::Range& range);
  /// Like `usual`, of either sign, or 0.
  double signed_usual(double least, double most, const scene::Range& range);
  json vector(double least, double most, const scene::Range& range);
  json direction();
  std::string fresh_name();  ///< that nothing in the scene has

  json grid();
  json triangle_mesh();
  json at(const json& mesh);
  json motion();
  json pins(const json& mesh);
  json weights(const json& mesh);
  json material();
  json mass();
  json transform();
  json start();
  json cloth(const std::string& name);
  json collider(const std::string& name);

  json change_cloth(const json& cloth);
  json change_cloths(const json& document);
  json change_colliders(const json& document);
  json change_solver();
  json change_self_collision();
  json change_wind();
  json as_operations(const json& document, const json& patch);

  std::mt19937_64 random_;
  int names_ = 0;
};

}  // namespace clothlab::test
