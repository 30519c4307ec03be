#include "server/model/glb.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace clothlab::model {

namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "a .glb file has numbers as they lie in memory");

// Of the specification, sections 3.6.2, 3.6.2.3 and 4.4.
constexpr int float_component = 5126, index_component = 5125, vertex_target = 34962, index_target = 34963;
constexpr std::uint32_t magic = 0x46546c67, version = 2, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

/// Normals of smooth shading, by area; straight up where a vertex has no triangle with an area.
std::vector<glm::vec3> smooth_normals(const Model& model, const std::vector<glm::vec3>& positions) {
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : model.triangles) {
    const glm::dvec3 origin(positions[a]);
    const glm::dvec3 twice_area =
        glm::cross(glm::dvec3(positions[b]) - origin, glm::dvec3(positions[c]) - origin);
    for (const std::uint32_t corner : {a, b, c}) sums[corner] += twice_area;
  }
  std::vector<glm::vec3> normals;
  normals.reserve(sums.size());
  for (const glm::dvec3& sum : sums) {
    const double size = glm::length(sum);
    normals.emplace_back(size > 0.0 && std::isfinite(size) ? sum / size : glm::dvec3(0.0, 1.0, 0.0));
  }
  return normals;
}

/// A colour "#rrggbb" in linear light, as glTF has it (IEC 61966-2-1).
json linear_colour(const std::string& colour) {
  json linear = json::array();
  for (std::size_t channel = 0; channel < 3; ++channel) {
    unsigned byte = 0;
    const char* digits = colour.data() + 1 + 2 * channel;
    std::from_chars(digits, digits + 2, byte, 16);
    const double share = byte / 255.0;
    linear.push_back(share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4));
  }
  linear.push_back(1.0);
  return linear;
}

template <class Vector>
json values(const Vector& v) {
  return {v.x, v.y, v.z};
}

class Writer {
 public:
  Writer(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& positions,
         const std::string& comment)
      : model_(model), positions_(positions), normals_(smooth_normals(model, positions)) {
    document_["asset"] = {{"version", "2.0"}, {"generator", "Clothlab"}, {"extras", {{"state", comment}}}};
    document_["scene"] = 0;
    document_["scenes"] = json::array({{{"name", scene.name}, {"nodes", json::array()}}});
    for (std::size_t cloth = 0; cloth < model.cloths.size(); ++cloth)
      add(model.cloths[cloth], scene.cloths[cloth]);
    document_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  }

  std::string bytes() const {
    std::string text = document_.dump();
    text.resize(padded(text.size()), ' ');
    std::string binary = binary_;
    binary.resize(padded(binary.size()), '\0');
    std::string file;
    const auto append = [&file](std::uint32_t word) {
      file.append(reinterpret_cast<const char*>(&word), sizeof word);
    };
    append(magic);
    append(version);
    append(static_cast<std::uint32_t>(28 + text.size() + binary.size()));
    append(static_cast<std::uint32_t>(text.size()));
    append(json_chunk);
    file += text;
    append(static_cast<std::uint32_t>(binary.size()));
    append(binary_chunk);
    file += binary;
    return file;
  }

 private:
  static std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

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

    const std::size_t position = accessor(places, "VEC3", float_component, vertex_target);
    document_["accessors"][position]["min"] = values(low);
    document_["accessors"][position]["max"] = values(high);
    const json attributes{{"POSITION", position},
                          {"NORMAL", accessor(of_cloth(normals_), "VEC3", float_component, vertex_target)},
                          {"TEXCOORD_0", accessor(texture, "VEC2", float_component, vertex_target)}};
    const std::size_t indices = accessor(corners, "SCALAR", index_component, index_target);
    const std::size_t number = document_["nodes"].size();
    document_["materials"].push_back({{"name", cloth.name},
                                      {"doubleSided", true},
                                      {"pbrMetallicRoughness",
                                       {{"baseColorFactor", linear_colour(cloth.color)},
                                        {"metallicFactor", 0.0},
                                        {"roughnessFactor", 0.9}}}});
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
