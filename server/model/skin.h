// The surface of bodies of triangles, and of solids, as cloth that is led out meets it: which vertices are
// inside, and the shortest way out. Internal to dress.cpp.
#pragma once

#include <memory>
#include <vector>

#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "server/model/dress_cloth.h"
#include "shaders/elements/elements.h"

namespace clothlab::model {

/// A solid at time 0, with a clearance [m] around it. To be called of solids only.
struct SolidThere {
  int kind;
  elements::Solid solid;
};
SolidThere solid_at_start(const scene::Collider& collider, double clearance);

class Skin {
 public:
  /// `x`: of the bodies' vertices [body_vertex_count] [m]. `clearance`: what contact keeps free [m].
  Skin(const Model& model, const scene::Scene& scene, const std::vector<dvec3>& x, double clearance);

  /// Chooses the side of open parts on which cloth is: that of most of its vertices.
  void choose_sides(const DressCloth& cloth);

  /// Adds what the vertices of `cloth` demand: to be out, and `clearance` away. Returns how many of those
  /// that can move are inside.
  std::size_t demand_outside(const DressCloth& cloth, std::vector<Demand>& demands);

  /// Adds what the cloth in these crossings with bodies demands. A pair that crosses again and again is
  /// pushed farther each time.
  void demand_apart(const DressCloth& cloth, const std::vector<Crossing>& crossings,
                    std::vector<Demand>& demands);

 private:
  struct Face {
    std::array<std::uint32_t, 3> corners;  ///< of the model's numbers
    dvec3 normal;                          ///< unit length, to the outside
    std::uint32_t part;                    ///< an open one's number; closed: not_open
    std::array<bool, 3> border;            ///< true if the side from corner k on has no other triangle
  };
  static constexpr std::uint32_t not_open = ~0u;

  struct Nearest {
    double distance = 0;
    dvec3 place{0.0}, normal{0.0};
    bool border = false;
    std::uint32_t part = not_open;
  };
  const dvec3& at(std::uint32_t vertex) const { return x_[vertex - first_]; }
  std::array<dvec3, 3> corners_of(const Face& face) const;
  void add_faces(const Model& model, std::uint32_t body);
  bool contained(const dvec3& point) const;
  /// The nearest face within `reach` [m], of closed parts or of open ones. False if there is none.
  bool nearest(const dvec3& point, double reach, bool open, Nearest& found) const;
  bool demand_of(const DressCloth& cloth, std::uint32_t vertex, std::vector<Demand>& demands);
  bool demand_of_solids(const DressCloth& cloth, std::uint32_t vertex, std::vector<Demand>& demands) const;
  dvec3 outwards(const Face& face) const;

  std::uint32_t first_;  // the number of the bodies' first vertex
  std::vector<dvec3> x_;
  double clearance_;
  std::vector<std::unique_ptr<BodyInside>> insides_;
  std::vector<Face> faces_[2];  // of closed parts those on the outside of all; of open ones all
  std::vector<Bounds> boxes_[2];
  std::unique_ptr<BoxTree> trees_[2];
  std::vector<double> sides_;  // of open parts: 1, or -1 where cloth is behind the faces
  std::map<std::array<std::uint32_t, 3>, Face> by_corners_;  // by their corners
  std::map<std::array<std::uint32_t, 2>, std::vector<Face>> at_edge_;
  std::vector<SolidThere> solids_;
  std::vector<bool> inside_;     // of the cloth's vertices, as found last
  std::vector<double> farther_;  // grows where a vertex's triangles cross again and again [m]
  double reach_ = 0;
};

}  // namespace clothlab::model
