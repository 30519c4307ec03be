// Binary glTF (Khronos Group, glTF 2.0 specification). Each frame but the first is a morph target: how far
// each place and normal is from that of the first. At a frame's time its target has the weight 1 and all
// others 0; between two frames both change linearly, and so the places do.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/base/text.h"
#include "server/film/formats.h"
#include "server/film/surface.h"
#include "server/model/gltf_parts.h"
#include "server/model/looks.h"

namespace clothlab::film {

namespace {

using nlohmann::json;
namespace gltf = model::gltf;

template <class Vector>
json values(const Vector& v) {
  return {v.x, v.y, v.z};
}

template <class Element>
std::string_view bytes_of(const std::vector<Element>& array) {
  return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof(Element)};
}

struct Bounds {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};
  void add(const glm::vec3& place) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
};

/// The places or normals of a cloth in a frame as they are in the file: those of the first, else the
/// differences from it.
std::vector<glm::vec3> written(std::span<const glm::vec3> now, std::span<const glm::vec3> first,
                               bool is_first) {
  std::vector<glm::vec3> out(now.begin(), now.end());
  if (!is_first)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] -= first[i];
  return out;
}

class GlbWriter {
 public:
  GlbWriter(const Film& film, const Put& put) : film_(film), put_(put) {}

  Status write() {
    const std::string times = formatted("%.9g to %.9g s", film_.from, film_.to);
    document_["asset"] = {{"version", "2.0"}, {"generator", "Clothlab"}, {"extras", {{"state", times}}}};
    document_["scene"] = 0;
    document_["scenes"] = json::array({{{"name", film_.title}, {"nodes", json::array()}}});
    add_times();
    for (const Cloth& cloth : film_.cloths) add(cloth);
    for (const Body& body : film_.bodies) add(body);
    if (Status added = add_frames(); !added) return added;
    const std::uint64_t bytes = fixed_.size() + frames_bytes();
    document_["buffers"] = json::array({{{"byteLength", bytes}}});
    const std::string head = gltf::binary_file_head(document_, bytes);
    if (Status put = put_(head); !put) return put;
    if (Status put = put_(fixed_); !put) return put;
    return film_.each_frame(
        [&](std::uint32_t frame, std::span<const glm::vec3> places) { return put_frame(frame, places); });
  }

 private:
  std::uint64_t frame_bytes() const { return std::uint64_t{film_.vertex_count()} * 2 * sizeof(glm::vec3); }
  std::uint64_t frames_bytes() const { return film_.frames() * frame_bytes(); }

  /// Appends an array to the bytes before the frames; returns its number among the accessors.
  template <class Element>
  std::size_t accessor(const std::vector<Element>& array, const char* type, int component, int target = 0) {
    const std::size_t components = sizeof(Element) / sizeof(float);
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", fixed_.size()}, {"byteLength", array.size() * sizeof(Element)}});
    if (target != 0) document_["bufferViews"].back()["target"] = target;
    const bool scalars = std::string_view(type) == "SCALAR";
    document_["accessors"].push_back({{"bufferView", document_["bufferViews"].size() - 1},
                                      {"componentType", component},
                                      {"count", scalars ? array.size() * components : array.size()},
                                      {"type", type}});
    fixed_ += bytes_of(array);
    return document_["accessors"].size() - 1;
  }

  std::size_t add_node(json node) {
    document_["nodes"].push_back(std::move(node));
    const std::size_t number = document_["nodes"].size() - 1;
    document_["scenes"][0]["nodes"].push_back(number);
    return number;
  }

  bool moves() const { return film_.frames() > 1; }

  /// The times of the frames, and the weights of the targets at them [frame, target].
  void add_times() {
    if (!moves()) return;
    const std::vector<float> times(film_.times.begin(), film_.times.end());
    times_ = accessor(times, "SCALAR", gltf::float_component);
    document_["accessors"][times_]["min"] = {times.front()};
    document_["accessors"][times_]["max"] = {times.back()};
    const std::size_t targets = times.size() - 1;
    std::vector<float> weights(times.size() * targets);
    for (std::size_t target = 0; target < targets; ++target) weights[(target + 1) * targets + target] = 1.0f;
    document_["animations"] = json::array({{{"name", film_.title}}});
    weights_ = sampler(accessor(weights, "SCALAR", gltf::float_component));
  }

  std::size_t sampler(std::size_t output) {
    json& samplers = document_["animations"][0]["samplers"];
    samplers.push_back({{"input", times_}, {"output", output}, {"interpolation", "LINEAR"}});
    return samplers.size() - 1;
  }
  void channel(std::size_t node, const char* path, std::size_t sampler) {
    document_["animations"][0]["channels"].push_back(
        {{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
  }

  void add(const Cloth& cloth) {
    std::vector<glm::vec2> texture(
        film_.texture_coordinates.begin() + cloth.first_vertex,
        film_.texture_coordinates.begin() + cloth.first_vertex + cloth.vertex_count);
    for (glm::vec2& at : texture) at.y = 1.0f - at.y;  // an image's first row is its upper one
    const json attributes{
        {"TEXCOORD_0", accessor(texture, "VEC2", gltf::float_component, gltf::vertex_target)}};
    const std::size_t indices =
        accessor(cloth.triangles, "SCALAR", gltf::index_component, gltf::index_target);
    document_["materials"].push_back(gltf::material(cloth.name, cloth.colour));
    json mesh{{"name", cloth.name},
              {"primitives", json::array({{{"attributes", attributes},
                                           {"indices", indices},
                                           {"material", document_["materials"].size() - 1}}})}};
    if (moves()) {
      json names = json::array();  // as Blender and three.js show them
      for (std::uint32_t frame = 1; frame < film_.frames(); ++frame)
        names.push_back(formatted("%.9g s", film_.from + film_.times[frame]));
      mesh["extras"] = {{"targetNames", std::move(names)}};
    }
    document_["meshes"].push_back(std::move(mesh));
    const std::size_t node = add_node({{"name", cloth.name}, {"mesh", document_["meshes"].size() - 1}});
    if (moves()) channel(node, "weights", weights_);
  }

  void add(const Body& body) {
    const Surface surface = surface_of(body.form);
    if (surface.triangles.empty()) return;
    const std::size_t position =
        accessor(surface.positions, "VEC3", gltf::float_component, gltf::vertex_target);
    Bounds bounds;
    for (const glm::vec3& place : surface.positions) bounds.add(place);
    document_["accessors"][position]["min"] = values(bounds.low);
    document_["accessors"][position]["max"] = values(bounds.high);
    const json attributes{
        {"POSITION", position},
        {"NORMAL", accessor(surface.normals, "VEC3", gltf::float_component, gltf::vertex_target)}};
    const std::size_t indices =
        accessor(surface.triangles, "SCALAR", gltf::index_component, gltf::index_target);
    if (!bodies_material_) {
      document_["materials"].push_back(gltf::material("body", bodies_colour));
      bodies_material_ = document_["materials"].size() - 1;
    }
    document_["meshes"].push_back({{"name", body.name},
                                   {"primitives", json::array({{{"attributes", attributes},
                                                                {"indices", indices},
                                                                {"material", *bodies_material_}}})}});
    place(body, document_["meshes"].size() - 1);
  }

  /// A node at the body's first pose, and its way. Where it is not there it has the size 0.
  void place(const Body& body, std::size_t mesh) {
    std::vector<glm::vec3> places, scales;
    std::vector<std::array<float, 4>> turns;
    Pose shown;
    for (const std::optional<Pose>& pose : body.poses)
      if (pose) {
        shown = *pose;  // until it comes it waits where it will
        break;
      }
    for (const std::optional<Pose>& pose : body.poses) {
      if (pose) shown = *pose;
      places.emplace_back(shown.place);
      scales.push_back(pose ? glm::vec3(pose->scale) : glm::vec3(0.0f));
      turns.push_back({static_cast<float>(shown.turn.x), static_cast<float>(shown.turn.y),
                       static_cast<float>(shown.turn.z), static_cast<float>(shown.turn.w)});
    }
    const std::size_t node = add_node({{"name", body.name},
                                       {"mesh", mesh},
                                       {"translation", values(places.front())},
                                       {"rotation", turns.front()},
                                       {"scale", values(scales.front())}});
    if (!body.moves()) return;
    const auto animate = [&](const auto& keys, const char* type, const char* path) {
      if (std::all_of(keys.begin(), keys.end(), [&](const auto& key) { return key == keys.front(); })) return;
      channel(node, path, sampler(accessor(keys, type, gltf::float_component)));
    };
    animate(places, "VEC3", "translation");
    animate(turns, "VEC4", "rotation");
    animate(scales, "VEC3", "scale");
  }

  /// The accessors of all frames: places, then normals, of one cloth after the other.
  Status add_frames() {
    document_["bufferViews"].push_back({{"buffer", 0},
                                        {"byteOffset", fixed_.size()},
                                        {"byteLength", frames_bytes()},
                                        {"byteStride", sizeof(glm::vec3)},
                                        {"target", gltf::vertex_target}});
    const std::size_t view = document_["bufferViews"].size() - 1;
    std::uint64_t offset = 0;
    return film_.each_frame([&](std::uint32_t frame, std::span<const glm::vec3> places) {
      if (frame == 0) first_.assign(places.begin(), places.end());
      for (std::size_t cloth = 0; cloth < film_.cloths.size(); ++cloth) {
        const Cloth& of = film_.cloths[cloth];
        json attributes;
        for (const bool normal : {false, true}) {
          json made{{"bufferView", view},
                    {"byteOffset", offset},
                    {"componentType", gltf::float_component},
                    {"count", of.vertex_count},
                    {"type", "VEC3"}};
          if (!normal) bound(made, written(part(places, of), part(first_, of), frame == 0));
          document_["accessors"].push_back(std::move(made));
          attributes[normal ? "NORMAL" : "POSITION"] = document_["accessors"].size() - 1;
          offset += of.vertex_count * sizeof(glm::vec3);
        }
        json& primitive = document_["meshes"][cloth]["primitives"][0];
        if (frame == 0)
          primitive["attributes"].update(attributes);
        else
          primitive["targets"].push_back(std::move(attributes));
      }
      return ok();
    });
  }

  static void bound(json& accessor, const std::vector<glm::vec3>& places) {
    Bounds bounds;
    for (const glm::vec3& place : places) bounds.add(place);
    accessor["min"] = values(bounds.low);
    accessor["max"] = values(bounds.high);
  }

  static std::span<const glm::vec3> part(std::span<const glm::vec3> all, const Cloth& cloth) {
    return all.subspan(cloth.first_vertex, cloth.vertex_count);
  }

  Status put_frame(std::uint32_t frame, std::span<const glm::vec3> places) {
    const std::vector<glm::vec3> normals = model::smooth_normals(film_.triangles, places);
    if (frame == 0) first_normals_ = normals;
    for (const Cloth& cloth : film_.cloths)
      for (const auto& array : {written(part(places, cloth), part(first_, cloth), frame == 0),
                                written(part(normals, cloth), part(first_normals_, cloth), frame == 0)})
        if (Status put = put_(bytes_of(array)); !put) return put;
    return ok();
  }

  const Film& film_;
  const Put& put_;
  json document_;
  std::string fixed_;        ///< the bytes before the frames
  std::size_t times_ = 0;    ///< an accessor
  std::size_t weights_ = 0;  ///< a sampler
  std::optional<std::size_t> bodies_material_;
  std::vector<glm::vec3> first_, first_normals_;  ///< of the first frame
};

}  // namespace

Status write_glb(const Film& film, const Put& put) {
  if (Status fits = check_size(".glb", film.frames(), film.vertex_count()); !fits) return fits;
  return GlbWriter(film, put).write();
}

}  // namespace clothlab::film
