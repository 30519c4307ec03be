// glTF 2.0 files (Khronos 2021), .glb or .gltf: the triangles of the scene's nodes, or of one node and what
// is below it, where the nodes' transforms put them; of skinned meshes in the pose that the file has. Texture
// coordinates are the first set, with v upwards.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "server/mesh/gltf_nodes.h"
#include "server/mesh/raw.h"

namespace clothlab::mesh {

namespace {

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;
using nlohmann::json;

dmat4 matrix_from(const double* numbers) {
  dmat4 matrix(0.0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix[column][row] = numbers[4 * column + row];
  return matrix;
}

bool turns_over(const dmat4& matrix) {
  return glm::dot(glm::cross(dvec3(matrix[0]), dvec3(matrix[1])), dvec3(matrix[2])) < 0.0;
}

class GltfReader {
 public:
  GltfReader(const std::string& name, const Limits& limits, const Reading& reading, const Beside& beside)
      : limits_(limits), node_(reading.node), data_(name, limits, beside) {
    raw_.name = name;
    raw_.mend = reading.mend;
    raw_.line_word = "face";
  }

  Result<Raw> read(std::string_view bytes) {
    if (const Status opened = data_.open(bytes); !opened) return opened.error();
    nodes_ = place_nodes(data_);
    std::vector<Visit> open;
    for (const std::size_t root : scene_roots()) open.push_back({root, node_.empty()});
    std::reverse(open.begin(), open.end());
    std::vector<char> seen(data_.count("nodes"), 0);
    while (!open.empty()) {
      const Visit at = open.back();
      open.pop_back();
      const Result<const json*> node = data_.item("nodes", at.node);
      if (!node) return node.error();
      if (seen[at.node]++) continue;
      const Result<std::size_t> mesh = data_.whole(**node, "mesh");
      if (!mesh) return mesh.error();
      const bool here = named(**node, *mesh);
      const bool wanted = at.wanted || here;
      if (wanted && *mesh != absent)
        if (const Status read = read_mesh(**node, at.node, *mesh); !read) return read.error();
      const std::vector<std::size_t> below = indices_in(**node, "children");
      for (auto child = below.rbegin(); child != below.rend(); ++child) open.push_back({*child, wanted});
    }
    if (!node_.empty() && !found_) return no_part(raw_.name, node_, raw_.parts);
    return std::move(raw_);
  }

 private:
  struct Visit {
    std::size_t node;
    bool wanted;
  };

  bool named(const json& node, std::size_t mesh) {
    const Result<const json*> of = mesh == absent ? Result<const json*>(&node) : data_.item("meshes", mesh);
    bool is = false;
    for (const std::string& name : {data_.name_of(node), of ? data_.name_of(**of) : std::string()}) {
      if (name.empty()) continue;
      is = is || name == node_;
      raw_.name_part(name);
    }
    found_ = found_ || is;
    return is;
  }

  /// Of the scene that the file shows, or of all nodes if it has none.
  std::vector<std::size_t> scene_roots() const {
    const Result<std::size_t> shown = data_.whole(data_.document(), "scene", 0);
    const Result<const json*> scene = shown ? data_.item("scenes", *shown) : shown.error();
    return scene ? indices_in(**scene, "nodes") : nodes_.roots;
  }

  Status read_mesh(const json& node, std::size_t node_index, std::size_t mesh_index) {
    const Result<const json*> mesh = data_.item("meshes", mesh_index);
    if (!mesh) return mesh.error();
    const Result<std::size_t> skin = data_.whole(node, "skin");
    if (!skin) return skin.error();
    joints_.clear();
    if (*skin != absent)
      if (const Status read = read_joints(*skin); !read) return read.error();
    const auto primitives = (*mesh)->find("primitives");
    if (primitives == (*mesh)->end() || !primitives->is_array()) return ok();
    for (const json& primitive : *primitives)
      if (primitive.is_object())
        if (const Status read = read_primitive(primitive, nodes_.global[node_index]); !read)
          return read.error();
    return ok();
  }

  /// What each joint of a skin does to a vertex.
  Status read_joints(std::size_t skin_index) {
    const Result<const json*> skin = data_.item("skins", skin_index);
    if (!skin) return skin.error();
    const std::vector<std::size_t> joints = indices_in(**skin, "joints");
    const Result<std::size_t> inverse = data_.whole(**skin, "inverseBindMatrices");
    if (!inverse) return inverse.error();
    work_ += joints.size();
    std::vector<double> matrices;
    if (*inverse != absent) {
      Result<std::vector<double>> read = data_.numbers(*inverse, 16, joints.size());
      if (!read) return read.error();
      matrices = std::move(*read);
    }
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i] >= nodes_.global.size())
        return data_.wrong("a joint that is no node", "an index of a node");
      const bool bound = matrices.size() >= 16 * (i + 1);
      joints_.push_back(nodes_.global[joints[i]] * (bound ? matrix_from(&matrices[16 * i]) : dmat4(1.0)));
    }
    return check_work();
  }

  /// Files may name the same numbers over and over.
  Status check_work() const {
    const std::size_t most = 32 * (limits_.triangles + limits_.vertices);
    return work_ > most ? Status(data_.wrong("more than " + std::to_string(most) + " numbers to read",
                                             "a file that has each part once"))
                        : ok();
  }

  /// The numbers of an attribute, or of the indices; empty: there are none.
  Result<std::vector<double>> numbers_of(const json& of, const char* key, std::size_t components,
                                         std::size_t most) {
    const Result<std::size_t> accessor = data_.whole(of, key);
    if (!accessor) return accessor.error();
    if (*accessor == absent) return std::vector<double>{};
    Result<std::vector<double>> numbers = data_.numbers(*accessor, components, most);
    if (!numbers) return numbers.error();
    work_ += numbers->size();
    if (const Status few = check_work(); !few) return few.error();
    return numbers;
  }

  Status read_primitive(const json& primitive, const dmat4& transform) {
    const Result<std::size_t> mode = data_.whole(primitive, "mode", triangle_list);
    if (!mode) return mode.error();
    const auto attributes = primitive.find("attributes"), extensions = primitive.find("extensions");
    if (*mode < triangle_list || attributes == primitive.end() || !attributes->is_object()) return ok();
    if (*mode > triangle_fan) return data_.wrong(std::to_string(*mode) + " as mode", "0 to 6");
    if (extensions != primitive.end() && extensions->contains("KHR_draco_mesh_compression"))
      return data_.wrong(
          "a mesh that is compressed (KHR_draco_mesh_compression)",
          "an export without compression, or what `npx @gltf-transform/cli copy` makes of the file");
    const Result<std::vector<double>> places = numbers_of(*attributes, "POSITION", 3, limits_.vertices),
                                      texture = numbers_of(*attributes, "TEXCOORD_0", 2, limits_.vertices),
                                      joints = numbers_of(*attributes, "JOINTS_0", 4, limits_.vertices),
                                      weights = numbers_of(*attributes, "WEIGHTS_0", 4, limits_.vertices);
    Result<std::vector<double>> indices = numbers_of(primitive, "indices", 1, 4 * limits_.triangles);
    for (const auto* each : {&places, &texture, &joints, &weights})
      if (!*each) return each->error();
    if (!indices) return indices.error();
    const std::size_t count = places->size() / 3;
    if (!primitive.contains("indices"))
      for (std::size_t i = 0; i < count; ++i) indices->push_back(static_cast<double>(i));
    const std::size_t first = raw_.vertices.size();
    const bool skinned = !joints_.empty() && joints->size() == 4 * count && weights->size() == 4 * count;
    for (std::size_t i = 0; i < count; ++i) {
      const dvec4 home((*places)[3 * i], (*places)[3 * i + 1], (*places)[3 * i + 2], 1.0);
      const dvec3 place =
          skinned ? posed(home, &(*joints)[4 * i], &(*weights)[4 * i]) : dvec3(transform * home);
      if (const Status added = add_vertex(place); !added) return added.error();
    }
    const bool textured =
        texture->size() == 2 * count && std::all_of(texture->begin(), texture->end(), [](double coordinate) {
          return std::abs(coordinate) <= largest_coordinate;
        });
    const std::size_t first_texture = raw_.texture.size();
    for (std::size_t i = 0; textured && i < count; ++i)
      raw_.texture.emplace_back((*texture)[2 * i], 1.0 - (*texture)[2 * i + 1]);
    return add_triangles(*indices, *mode, count, first, textured ? first_texture : absent,
                         !skinned && turns_over(transform));
  }

  dvec3 posed(const dvec4& home, const double* joints, const double* weights) const {
    dvec4 place(0.0);
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      if (!(weights[i] > 0.0) || !(joints[i] < static_cast<double>(joints_.size()))) continue;
      place += weights[i] * (joints_[static_cast<std::size_t>(joints[i])] * home);
      sum += weights[i];
    }
    return sum > 0.0 ? dvec3(place) / sum : dvec3(home);
  }

  Status add_vertex(const dvec3& place) {
    const std::size_t number = raw_.vertices.size();
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(place[axis]) <= largest_coordinate))  // true for NaN
        return raw_.add_placeless(data_.wrong("vertex " + std::to_string(number) + " with " +
                                                  std::to_string(place[axis]) + " as a coordinate",
                                              "a number from -1e+06 to 1e+06"),
                                  number, limits_);
    return raw_.add_vertex(place, number, limits_);
  }

  Status add_triangles(const std::vector<double>& indices, std::size_t mode, std::size_t count,
                       std::size_t first, std::size_t first_texture, bool turned) {
    const std::size_t step = mode == triangle_list ? 3 : 1;
    for (std::size_t i = 0; i + 2 < indices.size(); i += step) {
      std::array<double, 3> of{indices[mode == triangle_fan ? 0 : i], indices[i + 1], indices[i + 2]};
      ++face_;
      const bool joins = of[0] == of[1] || of[1] == of[2] || of[2] == of[0];
      if (joins && mode != triangle_list) continue;  // two parts of a strip
      if ((mode == triangle_strip && i % 2 == 1) != turned) std::swap(of[1], of[2]);
      corners_.clear();
      for (const double index : of) {
        if (!(index < static_cast<double>(count))) break;
        const auto at = static_cast<std::uint32_t>(index);
        corners_.push_back(
            {static_cast<std::uint32_t>(first) + at,
             first_texture == absent ? no_texture : static_cast<std::uint32_t>(first_texture) + at});
      }
      const Status added =
          corners_.size() == 3
              ? raw_.add_face(corners_, face_, limits_)
              : raw_.leave_out(
                    Fault::face, face_,
                    raw_.error(face_, "a corner that is none of " + std::to_string(count) + " vertices",
                               "an index of a vertex"));
      if (!added) return added.error();
    }
    return ok();
  }

  static constexpr std::size_t triangle_list = 4, triangle_strip = 5, triangle_fan = 6;
  const Limits& limits_;
  const std::string node_;
  GltfData data_;
  Raw raw_;
  GltfNodes nodes_;
  std::vector<dmat4> joints_;  // of the skin of the mesh that is read
  bool found_ = false;
  std::size_t face_ = 0;  // triangles so far
  std::size_t work_ = 0;  // numbers that were read
  std::vector<Corner> corners_;
};

}  // namespace

Result<Raw> read_gltf(std::string_view bytes, const std::string& name, const Limits& limits,
                      const Reading& reading, const Beside& beside) {
  return GltfReader(name, limits, reading, beside).read(bytes);
}

}  // namespace clothlab::mesh
