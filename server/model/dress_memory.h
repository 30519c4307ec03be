// What leading out has found last, as a scene is built several times: to be checked, to be run, and for each
// change of a number. Internal to dress.cpp.
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// Of all that the places depend on. `led_out`: of each cloth, whether it asks for it.
std::string dress_key(const Model& model, const scene::Scene& scene, const std::vector<std::uint8_t>& led_out,
                      std::size_t steps);

/// For all threads.
class DressMemory {
 public:
  struct Found {
    std::string key;
    Dressed dressed;
    std::vector<dvec3> places;
  };
  std::optional<Found> find(const std::string& key);
  void keep(Found found);

 private:
  static constexpr std::size_t most_kept = 8, most_vertices = 1u << 20;
  std::mutex mutex_;
  std::deque<Found> found_;   ///< the oldest first
  std::size_t vertices_ = 0;  ///< of all
};

}  // namespace clothlab::model
