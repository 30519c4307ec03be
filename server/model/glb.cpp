#include "server/model/glb.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "server/model/gltf_parts.h"
#include "server/model/looks.h"

namespace clothlab::model {

namespace {

using nlohmann::json;

template <class Vector>
json values(const Vector& v) {
  return {v.x, v.y, v.z};
}

class Writer {
 public:
  Writer(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& positions,
         const std::string& comment)
      : model_(model), positions_(positions), normals_(smooth_normals(model.triangles, positions)) {
    document_["asset"] = {{"version", "2.0"}, {"generator", "Clothlab"}, {"extras", {{"state", comment}}}};
    document_["scene"] = 0;
    document_["scenes"] = json::array({{{"name", scene.name}, {"nodes", json::array()}}});
    for (std::size_t cloth = 0; cloth < model.cloths.size(); ++cloth)
      add(model.cloths[cloth], scene.cloths[cloth]);
    document_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  }

  std::string bytes() const {
    std::string binary = binary_;
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    return gltf::binary_file_head(document_, binary.size()) + binary;
  }

 private:
  void add(const ClothRange& range, const scene::Cloth& cloth) {
    const auto first = static_cast<std::ptrdiff_t>(range.first_vertex);
    const auto of_cloth = [&](const auto& all) {
      return std::vector(all.begin() + first, all.begin() + first + range.vertex_count);
    };
    const std::vector<glm::vec3> places = of_cloth(positions_);
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const glm::vec3& place : places) {
      low = glm::min(low, place);
      high = glm::max(high, place);
    }
    std::vector<glm::vec2> texture = of_cloth(model_.texture_coordinates);
    for (glm::vec2& at : texture) at.y = 1.0f - at.y;  // an image's first row is its upper one
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = range.first_triangle; i < range.first_triangle + range.triangle_count; ++i)
      for (const std::uint32_t corner : model_.triangles[i]) corners.push_back(corner - range.first_vertex);

    const std::size_t position = accessor(places, "VEC3", gltf::float_component, gltf::vertex_target);
    document_["accessors"][position]["min"] = values(low);
    document_["accessors"][position]["max"] = values(high);
    const json attributes{
        {"POSITION", position},
        {"NORMAL", accessor(of_cloth(normals_), "VEC3", gltf::float_component, gltf::vertex_target)},
        {"TEXCOORD_0", accessor(texture, "VEC2", gltf::float_component, gltf::vertex_target)}};
    const std::size_t indices = accessor(corners, "SCALAR", gltf::index_component, gltf::index_target);
    const std::size_t number = document_["nodes"].size();
    document_["materials"].push_back(gltf::material(cloth.name, linear_colour(cloth.color)));
    document_["meshes"].push_back(
        {{"name", cloth.name},
         {"primitives",
          json::array({{{"attributes", attributes}, {"indices", indices}, {"material", number}}})}});
    document_["nodes"].push_back({{"name", cloth.name}, {"mesh", number}});
    document_["scenes"][0]["nodes"].push_back(number);
  }

  /// Appends an array; returns its number among the accessors.
  template <class Element>
  std::size_t accessor(const std::vector<Element>& array, const char* type, int component, int target) {
    const std::size_t bytes = array.size() * sizeof(Element), number = document_["accessors"].size();
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}, {"target", target}});
    document_["accessors"].push_back(
        {{"bufferView", number}, {"componentType", component}, {"count", array.size()}, {"type", type}});
    binary_.append(reinterpret_cast<const char*>(array.data()), bytes);
    return number;
  }

  const Model& model_;
  const std::vector<glm::vec3>& positions_;
  const std::vector<glm::vec3> normals_;
  json document_;
  std::string binary_;
};

}  // namespace

std::string glb_bytes(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& positions,
                      const std::string& comment) {
  return Writer(model, scene, positions, comment).bytes();
}

}  // namespace clothlab::model
