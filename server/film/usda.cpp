// A USD stage as text (Pixar, Universal Scene Description: the Usda format, UsdGeom and UsdPreviewSurface).
// Places and normals are time samples, as are the poses of bodies that move.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <initializer_list>
#include <set>

#include "server/base/text.h"
#include "server/film/formats.h"
#include "server/film/surface.h"
#include "server/model/looks.h"

namespace clothlab::film {

namespace {

/// The shortest text that reads back as the same number.
template <class Number>
void append(std::string& out, Number value) {
  char digits[32];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

template <class Vector>
void append_tuple(std::string& out, const Vector& v) {
  out += '(';
  for (int axis = 0; axis < v.length(); ++axis) {
    if (axis > 0) out += ", ";
    append(out, v[axis]);
  }
  out += ')';
}

template <class Vector>
std::string list(std::span<const Vector> vectors) {
  std::string out = "[";
  for (const Vector& each : vectors) {
    if (out.size() > 1) out += ", ";
    append_tuple(out, each);
  }
  return out + "]";
}

template <class Vector>
std::string tuple(const Vector& vector) {
  std::string out;
  append_tuple(out, vector);
  return out;
}

std::string quaternion(const glm::dquat& turn) {
  return tuple(glm::vec4(glm::dvec4(turn.w, turn.x, turn.y, turn.z)));
}

glm::dvec3 vector_of(const std::array<double, 3>& colour) {
  return {colour[0], colour[1], colour[2]};
}

/// Text between quotation marks.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') out += '\\';
    if (letter == '\n')
      out += "\\n";
    else
      out += letter;
  }
  return out + "\"";
}

std::string box(std::span<const glm::vec3> places) {
  glm::vec3 ends[2] = {places.front(), places.front()};
  for (const glm::vec3& place : places) {
    ends[0] = glm::min(ends[0], place);
    ends[1] = glm::max(ends[1], place);
  }
  return list<glm::vec3>(ends);
}

class UsdaWriter {
 public:
  UsdaWriter(const Film& film, const Put& put) : film_(film), put_(put) {}

  Status write() {
    const std::string root = prim_name(film_.title);
    text_ = "#usda 1.0\n(\n    defaultPrim = " + quoted(root) + "\n    doc = " +
            quoted("Clothlab: " + film_.title + ", " + formatted("%.9g to %.9g s", film_.from, film_.to)) +
            "\n    endTimeCode = " + time_code(film_.frames() - 1) + "\n    framesPerSecond = " + rate() +
            "\n    metersPerUnit = 1\n    startTimeCode = 0\n    timeCodesPerSecond = " + rate() +
            "\n    upAxis = \"Y\"\n)\n\ndef Xform " + quoted(root) + "\n{\n";
    root_ = "/" + root;
    names_.clear();
    const std::string looks = prim_name("Looks");
    std::vector<std::string> materials;
    text_ += "    def Scope " + quoted(looks) + "\n    {\n";
    for (const Cloth& cloth : film_.cloths)
      materials.push_back(add_material(looks, cloth.name, cloth.colour));
    const std::string bodies = film_.bodies.empty() ? "" : add_material(looks, "body", bodies_colour);
    text_ += "    }\n";
    for (std::size_t cloth = 0; cloth < film_.cloths.size(); ++cloth)
      if (Status added = add(film_.cloths[cloth], materials[cloth]); !added) return added;
    for (const Body& body : film_.bodies)
      if (Status added = add(body, bodies); !added) return added;
    text_ += "}\n";
    return flush();
  }

 private:
  Status flush() {
    const Status put = put_(text_);
    text_.clear();
    return put;
  }

  std::string rate() const {
    std::string out;
    append(out, film_.rate);
    return out;
  }

  std::string time_code(std::uint32_t frame) const {
    const double code = film_.times[frame] * film_.rate, whole = std::round(code);
    std::string out;
    append(out, std::abs(code - whole) < 1e-6 ? whole : code);
    return out;
  }

  /// A name as USD has them, of letters, digits and underscores, that no sibling has.
  std::string prim_name(const std::string& name) {
    std::string made;
    for (const char letter : name) {
      const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                         (letter >= '0' && letter <= '9');
      made += plain ? letter : '_';
    }
    if (made.empty() || (made[0] >= '0' && made[0] <= '9')) made.insert(0, "_");
    std::string unused = made;
    for (int number = 2; !names_.insert(unused).second; ++number)
      unused = made + "_" + std::to_string(number);
    return unused;
  }

  void line(int depth, const std::string& text) {
    text_.append(static_cast<std::size_t>(4 * depth), ' ').append(text) += '\n';
  }

  /// Returns the path of the material.
  std::string add_material(const std::string& scope, const std::string& name,
                           const std::array<double, 3>& colour) {
    const std::string prim = prim_name(name + "_look"), path = root_ + "/" + scope + "/" + prim;
    line(2, "def Material " + quoted(prim));
    line(2, "{");
    line(3, "token outputs:surface.connect = <" + path + "/surface.outputs:surface>");
    line(3, "def Shader \"surface\"");
    line(3, "{");
    line(4, "uniform token info:id = \"UsdPreviewSurface\"");
    line(4, "color3f inputs:diffuseColor = " + tuple(glm::vec3(vector_of(colour))));
    line(4, "float inputs:metallic = 0");
    line(4, "float inputs:roughness = 0.9");
    line(4, "token outputs:surface");
    line(3, "}");
    line(2, "}");
    return path;
  }

  /// Begins a prim of a shape that shows this material.
  void begin(const char* type, const std::string& name, const std::string& material,
             const std::array<double, 3>& colour) {
    line(1, "def " + std::string(type) + " " + quoted(prim_name(name)) + " (");
    line(2, "prepend apiSchemas = [\"MaterialBindingAPI\"]");
    line(1, ")");
    line(1, "{");
    line(2, "custom string userProperties:name = " + quoted(name));
    line(2, "rel material:binding = <" + material + ">");
    line(2, "color3f[] primvars:displayColor = [" + tuple(glm::vec3(vector_of(colour))) + "]");
  }

  void add_triangles(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::string counts, corners;
    for (const auto& triangle : triangles) {
      counts += counts.empty() ? "3" : ", 3";
      for (const std::uint32_t corner : triangle) {
        if (!corners.empty()) corners += ", ";
        append(corners, corner);
      }
    }
    line(2, "int[] faceVertexCounts = [" + counts + "]");
    line(2, "int[] faceVertexIndices = [" + corners + "]");
    line(2, "uniform bool doubleSided = 1");
    line(2, "uniform token subdivisionScheme = \"none\"");
  }

  Status add(const Cloth& cloth, const std::string& material) {
    begin("Mesh", cloth.name, material, cloth.colour);
    add_triangles(cloth.triangles);
    line(2, "texCoord2f[] primvars:st = " +
                list(std::span(film_.texture_coordinates).subspan(cloth.first_vertex, cloth.vertex_count)) +
                " (");
    line(3, "interpolation = \"vertex\"");
    line(2, ")");
    line(2, "normal3f[] normals (");
    line(3, "interpolation = \"vertex\"");
    line(2, ")");
    const auto part = [&](std::span<const glm::vec3> all) {
      return all.subspan(cloth.first_vertex, cloth.vertex_count);
    };
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, Value>>{
             {"float3[] extent", [&](std::span<const glm::vec3> all) { return box(part(all)); }},
             {"normal3f[] normals",
              [&](std::span<const glm::vec3> all) {
                return list(part(model::smooth_normals(film_.triangles, all)));
              }},
             {"point3f[] points", [&](std::span<const glm::vec3> all) { return list(part(all)); }}})
      if (Status added = add_samples(name, value); !added) return added;
    line(1, "}");
    return ok();
  }

  /// The time samples of an attribute, from each frame's places.
  using Value = std::function<std::string(std::span<const glm::vec3>)>;
  Status add_samples(const std::string& attribute, const Value& value) {
    line(2, attribute + ".timeSamples = {");
    const Status gone = film_.each_frame([&](std::uint32_t frame, std::span<const glm::vec3> places) {
      line(3, time_code(frame) + ": " + value(places) + ",");
      return flush();
    });
    line(2, "}");
    return gone;
  }

  Status add(const Body& body, const std::string& material) {
    const Form& form = body.form;
    std::string radius;
    append(radius, form.radius);
    switch (form.kind) {
      case Form::Kind::ball:
        begin("Sphere", body.name, material, bodies_colour);
        line(2, "double radius = 1");
        line(2, "float3[] extent = [(-1, -1, -1), (1, 1, 1)]");
        break;
      case Form::Kind::box:
        begin("Cube", body.name, material, bodies_colour);
        line(2, "double size = 2");
        line(2, "float3[] extent = [(-1, -1, -1), (1, 1, 1)]");
        break;
      case Form::Kind::capsule: {
        begin("Capsule", body.name, material, bodies_colour);
        line(2, "uniform token axis = \"X\"");
        line(2, "double height = " + with_significant_digits(2 * form.half_length, 17));
        line(2, "double radius = " + radius);
        const glm::vec3 far(glm::dvec3(form.half_length + form.radius, form.radius, form.radius));
        line(2, "float3[] extent = [" + tuple(-far) + ", " + tuple(far) + "]");
        break;
      }
      case Form::Kind::square:
      case Form::Kind::mesh: {
        const Surface surface = surface_of(form);
        if (surface.triangles.empty()) return ok();
        begin("Mesh", body.name, material, bodies_colour);
        add_triangles(surface.triangles);
        line(2, "float3[] extent = " + box(surface.positions));
        line(2, "point3f[] points = " + list(std::span<const glm::vec3>(surface.positions)));
        break;
      }
    }
    place(body);
    line(1, "}");
    return flush();
  }

  /// The value of each frame in which the body is there, or one value if it never changes.
  void add_motion(const Body& body, const std::string& attribute,
                  const std::function<std::string(const Pose&)>& value) {
    std::string samples, first;
    bool changes = false;
    for (std::uint32_t frame = 0; frame < film_.frames(); ++frame) {
      if (!body.poses[frame]) continue;
      const std::string text = value(*body.poses[frame]);
      if (first.empty()) first = text;
      changes = changes || text != first;
      samples += "            " + time_code(frame) + ": " + text + ",\n";
    }
    if (!changes) return line(2, attribute + " = " + first);
    line(2, attribute + ".timeSamples = {");
    text_ += samples;
    line(2, "}");
  }

  void place(const Body& body) {
    add_motion(body, "double3 xformOp:translate", [](const Pose& pose) { return tuple(pose.place); });
    add_motion(body, "quatf xformOp:orient", [](const Pose& pose) { return quaternion(pose.turn); });
    add_motion(body, "float3 xformOp:scale", [](const Pose& pose) { return tuple(glm::vec3(pose.scale)); });
    line(2, "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\", \"xformOp:scale\"]");
    if (body.always_there()) return;
    line(2, "token visibility.timeSamples = {");
    for (std::uint32_t frame = 0; frame < film_.frames(); ++frame)
      line(3, time_code(frame) + ": " + (body.poses[frame] ? "\"inherited\"," : "\"invisible\","));
    line(2, "}");
  }

  const Film& film_;
  const Put& put_;
  std::string text_;             ///< not handed on yet
  std::string root_;             ///< the path of the prim that has all others
  std::set<std::string> names_;  ///< of prims so far
};

}  // namespace

Status write_usda(const Film& film, const Put& put) {
  return UsdaWriter(film, put).write();
}

}  // namespace clothlab::film
