// The scene as typed, validated plain data: what every other part of the server reads. See README.md here.
// Made only by `validate` (scene/document.h); a Scene in hand is a valid one. All quantities SI.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

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

/// A mesh given in the document itself.
struct TriangleMesh {
  std::vector<dvec3> vertices;                          ///< [vertex_count] [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [triangle_count], counter-clockwise
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
  /// The most a spring may exceed its rest length after a step, as a share of it; Provot 1995. None: no
  /// limit.
  std::optional<double> strain_limit = std::nullopt;
  bool operator==(const Springs&) const = default;
};

/// home + amplitude * axis * sin(2 pi frequency t); the axis is normalised.
struct Oscillate {
  dvec3 axis{0.0, 0.0, 1.0};
  double amplitude = 0.0;  ///< [m]
  double frequency = 0.0;  ///< [Hz]
  bool operator==(const Oscillate&) const = default;
};
/// home + velocity * t.
struct Linear {
  dvec3 velocity{0.0};  ///< [m/s]
  bool operator==(const Linear&) const = default;
};
/// home turned about the line through `center` along `axis`.
struct Spin {
  dvec3 axis{0.0, 1.0, 0.0};
  dvec3 center{0.0};  ///< [m]
  double degrees_per_second = 0.0;
  bool operator==(const Spin&) const = default;
};
/// How a pin or a collider moves; monostate: it does not (`null` in the document).
using Motion = std::variant<std::monostate, Oscillate, Linear, Spin>;

/// Which vertices of its cloth a pin holds.
struct AtCorner {
  int column = 0, row = 0;  ///< grids only; any vertex of the grid by its column and row
  bool operator==(const AtCorner&) const = default;
};
struct AtVertex {
  std::uint32_t vertex = 0;
  bool operator==(const AtVertex&) const = default;
};
struct AtEdge {
  enum class Line { row, column } line = Line::row;
  int index = 0;  ///< grids only
  bool operator==(const AtEdge&) const = default;
};
struct AtBox {
  dvec3 minimum{0.0}, maximum{0.0};  ///< [m], world space, against the transformed rest positions
  bool operator==(const AtBox&) const = default;
};
using At = std::variant<AtCorner, AtVertex, AtEdge, AtBox>;

struct Pin {
  At at;
  Motion motion;
  bool operator==(const Pin&) const = default;
};

/// Mass on top of the cloth's own, such as a weight sewn into a hem.
struct Weight {
  At at;
  double mass = 0.0;  ///< added to each of the vertices [kg], above 0
  bool operator==(const Weight&) const = default;
};

/// Free vertices start at pseudo-random places in a cube about the middle of the cloth's rest shape.
struct Scatter {
  double size = 1.0;       ///< the cube's edge [m]
  std::uint32_t seed = 1;  ///< the same seed, the same places, on every machine
  bool operator==(const Scatter&) const = default;
};
/// Free vertices start with their place relative to the middle of the cloth's rest shape scaled along the
/// axes of the world: (1, 1, 0) makes it flat, (0, 0, 0) a point.
struct Stretch {
  dvec3 scale{1.0};
  bool operator==(const Stretch&) const = default;
};
/// Where the free vertices are at time 0; monostate: in the rest shape. Rest lengths are those of the rest
/// shape always.
using Start = std::variant<std::monostate, Scatter, Stretch>;

struct Cloth {
  std::string name = "cloth";
  Mesh mesh;
  Transform transform;
  Mass mass;
  Springs material;
  std::vector<Pin> pins;
  std::vector<Weight> weights;
  Start start;
  std::string color = "#b03a2e";  ///< #rrggbb
  std::string texture = "weave";  ///< weave | checker | stripes | plain
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
/// What each of them is to others, and how it is read: solid.h.
using Shape = std::variant<Sphere, Plane>;

struct Collider {
  std::string name;
  Shape shape;
  double friction = 0.0;     ///< Coulomb coefficient, 0 or more
  double restitution = 0.0;  ///< [0, 1]
  Motion motion;
  bool operator==(const Collider&) const = default;
};

struct SelfCollision {
  double thickness = 0.01;  ///< [m]: vertices are kept this far apart
  double friction = 0.0;    ///< Coulomb coefficient, 0 or more
  bool operator==(const SelfCollision&) const = default;
};

/// How the scene is advanced in time. scene/method.h has their names.
enum class Method { explicit_euler, symplectic_euler, verlet, rk4, implicit_euler, pbd, xpbd, vbd };

struct Solver {
  Method method = Method::symplectic_euler;
  double dt = 0.001;  ///< [s]
  int iterations = 10;
  double tolerance = 1e-4;
  /// The document says "auto": the lab is to choose so that `tolerance` is kept, an RMS position error over
  /// the cloth's size. Until it has, and after it has, the other values say how to step.
  bool automatic = false;
  bool operator==(const Solver&) const = default;
};

struct Scene {
  std::string name;
  dvec3 gravity{0.0, -9.8, 0.0};  ///< [m/s^2]
  std::vector<Cloth> cloths;      ///< one or more
  std::vector<Collider> colliders;
  std::optional<SelfCollision> self_collision;
  double air_drag = 0.0;  ///< [1/s]
  Solver solver;
  bool operator==(const Scene&) const = default;
};

}  // namespace clothlab::scene
