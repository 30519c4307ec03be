// The scene as typed plain data, which every other part of the server reads. See README.md here. Only
// `validate` (scene/document.h) makes a Scene from a document, so every Scene is valid. All values are SI.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/scene/method.h"

namespace clothlab::scene {

using glm::dvec3;

/// A rectangle in the x-z plane: x in [-width/2, width/2] along columns, z in [0, height] along rows.
struct Grid {
  int columns = 25;     ///< vertices along x, 2 or more
  int rows = 25;        ///< vertices along z, 2 or more
  double width = 1.0;   ///< [m]
  double height = 1.0;  ///< [m]
  bool operator==(const Grid&) const = default;
};

/// A run of a panel's outline: its vertices in order.
struct NamedRun {
  std::string name;
  std::vector<std::uint32_t> vertices;
  bool operator==(const NamedRun&) const = default;
};

/// A mesh given in the document itself, made of a panel there, or read from a file that the document names.
struct TriangleMesh {
  std::vector<dvec3> vertices;                          ///< [vertex_count] [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [triangle_count], counter-clockwise
  /// [triangle_count] where each triangle's corners lie in the flat pattern that the cloth was cut by [m], to
  /// be scaled like `vertices`; empty: the cloth at rest has the shape of `vertices`. A vertex on a seam has
  /// a place in each panel.
  std::vector<std::array<glm::dvec2, 3>> pattern{};
  /// Of a file: [vertices of the file] the vertex that became of each, or mesh::no_vertex. Documents count
  /// the vertices of the file. Empty: every vertex has its own number.
  std::vector<std::uint32_t> vertex_of{};
  std::vector<std::string> notes{};  ///< what a person should know of it, in sentences (mesh::Mesh::notes)
  std::vector<NamedRun> runs{};      ///< of a panel
  bool operator==(const TriangleMesh&) const = default;
};

using Mesh = std::variant<Grid, TriangleMesh>;

/// Scales, rotates about x, then y, then z, then translates.
struct Transform {
  dvec3 translate{0.0};  ///< [m]
  dvec3 rotate{0.0};     ///< [degrees]
  double scale = 1.0;    ///< above 0
  bool operator==(const Transform&) const = default;
};

/// Mass: the same for every vertex, or by area.
struct Mass {
  enum class Kind { per_vertex, area_density } kind = Kind::per_vertex;
  double value = 0.1;  ///< [kg] or [kg/m^2], above 0
  bool operator==(const Mass&) const = default;
};

/// Mass-spring material. A stiffness of 0 removes the springs of that kind.
struct Springs {
  double structural = 20000.0;  ///< [N/m]
  double shear = 10000.0;       ///< [N/m]
  double bend = 2000.0;         ///< [N/m]
  double damping = 2.0;         ///< [N s/m], along the spring
  /// The largest extension of a spring after a step, as a share of its rest length (Provot 1995). None: no
  /// limit.
  std::optional<double> strain_limit = std::nullopt;
  bool operator==(const Springs&) const = default;
};

/// The largest extension along warp and weft after a step, as a share of the rest length.
struct StrainLimit {
  double warp, weft;
  StrainLimit(double alike) : warp(alike), weft(alike) {}
  StrainLimit(double along_warp, double along_weft) : warp(along_warp), weft(along_weft) {}
  bool operator==(const StrainLimit&) const = default;
};

/// Woven or knitted material as a continuum: finite elements. Warp and weft are the two directions of its
/// threads.
struct Fem {
  double warp = 2365.0;  ///< tension [N] a metre of width over strain, pulled along the warp alone, above 0
  double weft = 3801.0;  ///< the same along the weft
  double poisson =
      0.311;            ///< contraction along the weft over stretch along the warp; poisson^2 < warp / weft
  double shear = 97.0;  ///< [N/m]
  /// Moment [N m] a metre of width over curvature: bent along the warp, along the weft, and twisted.
  struct Bending {
    double warp = 8e-6, weft = 12e-6;
    std::optional<double> twist =
        std::nullopt;  ///< none: half of what warp and weft have on (geometric) average
    bool operator==(const Bending&) const = default;
  } bending;
  double damping = 0.001;  ///< time by which stress and moment run ahead of strain and curvature [s]
  double grain = 0.0;      ///< from the mesh's first texture axis to the warp [degrees]
  std::optional<StrainLimit> strain_limit = std::nullopt;  ///< none: no limit
  bool operator==(const Fem&) const = default;
};
using Material = std::variant<Springs, Fem>;

/// The place at time t is home + amplitude * axis * sin(2 pi frequency t), where home is the place at time 0.
struct Oscillate {
  dvec3 axis{0.0, 0.0, 1.0};  ///< unit length
  double amplitude = 0.0;     ///< [m]
  double frequency = 0.0;     ///< [Hz]
  bool operator==(const Oscillate&) const = default;
};
/// The place at time t is home + velocity * t.
struct Linear {
  dvec3 velocity{0.0};  ///< [m/s]
  bool operator==(const Linear&) const = default;
};
/// The place at time t is home turned by degrees_per_second * t about the line through `center` along `axis`.
struct Spin {
  dvec3 axis{0.0, 1.0, 0.0};  ///< unit length
  dvec3 center{0.0};          ///< [m]
  double degrees_per_second = 0.0;
  bool operator==(const Spin&) const = default;
};
/// A pin that holds its vertex at `place` instead of its rest place; home is there. If the scene has it at
/// time 0 it is then at the rest place, as a start that is torn out of shape would blow up, and `glide` later
/// at `place`.
struct Placed {
  static constexpr double glide = 0.5;  ///< [s]
  dvec3 place{0.0};                     ///< [m]
  std::variant<std::monostate, Oscillate, Linear, Spin> then;
  bool operator==(const Placed&) const = default;
};
/// How a pin or a collider moves; monostate: it does not (`null` in the document). Only pins are `Placed`.
using Motion = std::variant<std::monostate, Oscillate, Linear, Spin, Placed>;
inline bool has_motion(const Motion& motion) {
  return !std::holds_alternative<std::monostate>(motion);
}

/// A vertex of a grid by its column and row, counted from 0. Despite the name it can be any vertex.
struct AtCorner {
  int column = 0, row = 0;  ///< grids only
  bool operator==(const AtCorner&) const = default;
};
/// A vertex of any mesh by its index.
struct AtVertex {
  std::uint32_t vertex = 0;
  bool operator==(const AtVertex&) const = default;
};
/// All vertices of one row or column of a grid.
struct AtEdge {
  enum class Line { row, column } line = Line::row;
  int index = 0;  ///< grids only
  bool operator==(const AtEdge&) const = default;
};
/// All vertices whose transformed rest positions lie in a box, its faces included.
struct AtBox {
  dvec3 minimum{0.0}, maximum{0.0};  ///< [m], world space
  bool operator==(const AtBox&) const = default;
};
/// The vertices of a cloth that a pin holds or that a weight is added to.
using At = std::variant<AtCorner, AtVertex, AtEdge, AtBox>;

struct Pin {
  At at;
  Motion motion;
  bool held = true;  ///< false: it has let its vertices go, by a key (keys.h); true in every document
  bool operator==(const Pin&) const = default;
};

/// Mass on top of the cloth's own, such as a weight sewn into a hem.
struct Weight {
  At at;
  double mass = 0.0;  ///< added to each vertex of `at` [kg], above 0
  bool operator==(const Weight&) const = default;
};

/// Free vertices start at pseudo-random places in a cube about the middle of the cloth's rest shape.
struct Scatter {
  double size = 1.0;       ///< the cube's edge [m]
  std::uint32_t seed = 1;  ///< the same seed gives the same places on every machine
  bool operator==(const Scatter&) const = default;
};
/// Free vertices start in the rest shape scaled about its middle along the world axes: (1, 1, 0) makes the
/// cloth flat, (0, 0, 0) makes it a point.
struct Stretch {
  dvec3 scale{1.0};
  bool operator==(const Stretch&) const = default;
};
/// Free vertices start in the rest shape, led out of bodies and of cloth (model/dress.h).
struct Dress {
  double seconds = 0.0;  ///< of leading out, at most [s]
  bool operator==(const Dress&) const = default;
};
/// Where the free vertices are at time 0; monostate: in the rest shape. Rest lengths always come from the
/// rest shape.
using Start = std::variant<std::monostate, Scatter, Stretch, Dress>;

struct Cloth {
  std::string name = "cloth";
  Mesh mesh;
  Transform transform;
  Mass mass;
  Material material;
  std::vector<Pin> pins;
  std::vector<Weight> weights;
  Start start;
  std::string color = "#b03a2e";  ///< #rrggbb
  std::string texture = "weave";  ///< weave | checker | stripes | plain

  /// The material of a cloth of springs; to be called of such a cloth only.
  Springs& springs() { return std::get<Springs>(material); }
  const Springs& springs() const { return std::get<Springs>(material); }
  /// Whatever the material.
  double damping() const {
    return std::visit([](const auto& of) { return of.damping; }, material);
  }
  /// That of its springs counts for both directions.
  std::optional<StrainLimit> strain_limit() const {
    return std::visit([](const auto& of) -> std::optional<StrainLimit> { return of.strain_limit; }, material);
  }
  bool operator==(const Cloth&) const = default;
};

struct Sphere {
  dvec3 center{0.0};    ///< [m]
  double radius = 0.1;  ///< [m]
  bool operator==(const Sphere&) const = default;
};
/// The half-space behind the plane is solid.
struct Plane {
  dvec3 point{0.0};             ///< [m]
  dvec3 normal{0.0, 1.0, 0.0};  ///< normalised
  bool operator==(const Plane&) const = default;
};
/// Everything within `radius` of the line from `a` to `b`; a sphere if they are the same point.
struct Capsule {
  dvec3 a{0.0}, b{0.0};  ///< [m]
  double radius = 0.1;   ///< [m]
  bool operator==(const Capsule&) const = default;
};
/// A cuboid. Its edges at home are along x, y and z.
struct Box {
  dvec3 center{0.0};     ///< [m]
  dvec3 half{0.1};       ///< of the edges [m]
  glm::dmat3 axes{1.0};  ///< turns it out of its home
  bool operator==(const Box&) const = default;
};
/// A rigid body of triangles, from the document or a file. Cloth keeps to the side of its triangles on which
/// it starts.
struct Body {
  std::shared_ptr<const TriangleMesh> mesh = std::make_shared<const TriangleMesh>();  ///< never null
  Transform transform;  ///< from the mesh to the world
  bool operator==(const Body& other) const {
    return transform == other.transform && (mesh == other.mesh || *mesh == *other.mesh);
  }
};
/// The shape of a collider. solid.h has the functions for code that need not know which kind it is. All but
/// the last kind are solids: one law for a vertex has them all (shaders/elements/solid.glsl).
using Shape = std::variant<Sphere, Plane, Capsule, Box, Body>;

struct Collider {
  std::string name;
  Shape shape;
  double friction = 0.0;     ///< Coulomb coefficient, 0 or more
  double restitution = 0.0;  ///< [0, 1]
  Motion motion;
  bool is_body() const { return std::holds_alternative<Body>(shape); }
  bool operator==(const Collider&) const = default;
};

inline bool any_has_motion(const std::vector<Collider>& colliders) {
  return std::any_of(colliders.begin(), colliders.end(),
                     [](const Collider& each) { return has_motion(each.motion); });
}

/// What self-collision keeps apart: vertices, or triangles and edges, which then never pass through each
/// other.
enum class ContactKind { points, surface };

struct SelfCollision {
  double thickness = 0.01;  ///< [m]: vertices, or surfaces, are kept this far apart
  double friction = 0.0;    ///< Coulomb coefficient, 0 or more
  ContactKind kind = ContactKind::points;
  bool operator==(const SelfCollision&) const = default;
};

/// Air that flows past the cloths, the same everywhere. At time t it flows with velocity * (1 + gust * sin(2
/// pi gust_frequency t)). It blows through cloths and colliders onto what is behind them.
struct Wind {
  dvec3 velocity{0.0};          ///< [m/s]; 0: air at rest, which brakes
  double gust = 0.0;            ///< share of the velocity, 0 or more
  double gust_frequency = 0.7;  ///< [Hz]
  double drag = 1.0;            ///< coefficient, of a triangle's area, 0 or more
  double lift = 0.2;            ///< coefficient, 0 or more
  bool operator==(const Wind&) const = default;
};

struct Solver {
  Method method = Method::symplectic_euler;
  double dt = 0.001;  ///< [s]
  int iterations = 10;
  double tolerance = 1e-4;
  /// True if the document's method is "auto": the lab chooses how to step so that the RMS position error, as
  /// a share of the cloth's size, is at most `tolerance`. The other fields say how to step at present, before
  /// and after that choice.
  bool automatic = false;
  bool operator==(const Solver&) const = default;
};

/// How a keyed value goes from one keyframe to the next: evenly, with rest at both (3 s^2 - 2 s^3 of the way
/// at the share s of the time), or at once at the later one.
enum class Ease { linear, smooth, step };

/// A value of the scene by times (keys.h); before the first and after the last it is theirs.
struct Key {
  std::string of;  ///< a JSON Pointer
  Ease ease = Ease::linear;
  std::vector<double> times{};  ///< [s], one or more, 0 or more, rising
  std::vector<dvec3> values{};  ///< one for each; a number is in x, a pin that is held is 1 in x
  bool operator==(const Key&) const = default;
};

struct Scene {
  std::string name;
  dvec3 gravity{0.0, -9.8, 0.0};  ///< [m/s^2]
  std::vector<Cloth> cloths;      ///< one or more
  std::vector<Collider> colliders;
  std::optional<SelfCollision> self_collision;
  std::optional<Wind> wind;
  double air_drag = 0.0;  ///< [1/s]
  Solver solver;
  std::vector<Key> keys;  ///< each of another value; they count more than the value that the scene has
  /// True if a collider is no body of triangles.
  bool has_solids() const {
    return std::any_of(colliders.begin(), colliders.end(), [](const Collider& of) { return !of.is_body(); });
  }
  /// True if self-collision is of this kind.
  bool collides(ContactKind kind) const { return self_collision && self_collision->kind == kind; }
  bool operator==(const Scene&) const = default;
};

/// What a person should know of the meshes of the scene's cloths and bodies, a sentence each, with the place
/// in the document.
std::vector<std::string> mesh_notes(const Scene& scene);

}  // namespace clothlab::scene
