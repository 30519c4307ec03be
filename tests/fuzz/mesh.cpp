// A triangle mesh from raw bytes, with indices and coordinates that a text would seldom contain: as a
// document, for the validation; then as a model, as files and as a topology message.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/decode/frame.h"
#include "server/model/constraint_gains.h"
#include "server/model/mesh_file.h"
#include "server/stream/frame.h"
#include "tests/fuzz/document.h"

using namespace clothlab;

namespace {

/// Reads numbers from the front of the input; 0 once the input is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof value, size_);
    if (count > 0) std::memcpy(&value, data_, count);
    data_ += count;
    size_ -= count;
    return value;
  }
  bool empty() const { return size_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// Mostly a small number, so that vertices coincide or lie in line; sometimes any float.
double coordinate(Bytes& bytes) {
  const auto byte = bytes.take<std::int8_t>();
  if (byte != -128) return byte / 16.0;
  const auto any = bytes.take<float>();
  return std::isfinite(any) ? static_cast<double>(any) : 0.0;
}

/// An index near the number of vertices, on both sides, or far beyond.
std::int64_t index(Bytes& bytes) {
  const auto byte = bytes.take<std::uint8_t>();
  return byte == 255 ? bytes.take<std::int64_t>() : byte;
}

scene::json number(Bytes& bytes) {
  constexpr double numbers[] = {0.0, 1.0, 0.2, 1e-9, 1e6, 1e-6, 20000.0, 1e12};
  return numbers[bytes.take<std::uint8_t>() % 8];
}

scene::json at_vertex(Bytes& bytes) {
  return {{"at", "vertex:" + std::to_string(index(bytes))}};
}

scene::json cloth_of(Bytes& bytes) {
  scene::json vertices = scene::json::array(), triangles = scene::json::array();
  const std::size_t vertex_count = bytes.take<std::uint8_t>() % 48,
                    triangle_count = bytes.take<std::uint8_t>() % 96;
  const auto options = bytes.take<std::uint8_t>();
  scene::json cloth = {
      {"mesh", {{"vertices", nullptr}, {"triangles", nullptr}}},
      {"mass", {{options & 1 ? "area_density" : "per_vertex", number(bytes)}}},
      {"material", {{"structural", number(bytes)}, {"bend", number(bytes)}, {"damping", number(bytes)}}}};
  if (options & 2)
    cloth["transform"] = {{"scale", number(bytes)}, {"translate", scene::json::array({number(bytes), 0, 0})}};
  if (options & 4) cloth["pins"] = scene::json::array({at_vertex(bytes)});
  if (options & 8) cloth["start"] = {{"scatter", {{"size", number(bytes)}}}};
  if (options & 16) {
    scene::json weight = at_vertex(bytes);
    weight["mass"] = number(bytes);
    cloth["weights"] = scene::json::array({weight});
  }
  for (std::size_t i = 0; i < vertex_count; ++i)
    vertices.push_back(scene::json::array({coordinate(bytes), coordinate(bytes), coordinate(bytes)}));
  for (std::size_t i = 0; i < triangle_count && !bytes.empty(); ++i)
    triangles.push_back(scene::json::array({index(bytes), index(bytes), index(bytes)}));
  cloth["mesh"] = {{"vertices", std::move(vertices)}, {"triangles", std::move(triangles)}};
  return cloth;
}

/// The exports of a model: every file is whole, and a viewer can read the message.
void require_exports(const model::Model& model) {
  std::vector<glm::vec3> positions;
  for (const glm::dvec3& position : model.start_position) positions.emplace_back(position);
  const std::string obj = model::obj_text(model, positions, "fuzz");
  fuzz::require(static_cast<std::size_t>(std::count(obj.begin(), obj.end(), '\n')) ==
                    1 + 2 * positions.size() + model.triangles.size(),
                "an OBJ file has a line for everything");
  fuzz::require(obj.find("nan") == std::string::npos && obj.find("inf") == std::string::npos,
                "an OBJ file has numbers");
  const std::string ply = model::ply_bytes(model, positions, "fuzz");
  const std::size_t head = ply.find("end_header\n") + 11;
  fuzz::require(ply.size() == head + 20 * positions.size() + 13 * model.triangles.size(),
                "a PLY file is whole");
  const stream::SharedMessage message = stream::encode_topology(model, 7);
  const Result<decode::Decoded> decoded = decode::decode_frame({message->data(), message->size()});
  fuzz::require(bool(decoded), "a topology message is read", decoded ? "" : decoded.error().text());
  const auto* topology = std::get_if<decode::Topology>(&decoded->payload);
  fuzz::require(topology && decoded->header.vertex_count == model.vertex_count() &&
                    topology->triangles == model.triangles && topology->cloths.size() == model.cloths.size(),
                "a topology message says what the model is");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  scene::json value = {{"version", 1}, {"cloths", scene::json::array()}};
  constexpr const char* methods[] = {"explicit_euler", "symplectic_euler", "verlet", "rk4", "pbd"};
  value["solver"]["method"] = methods[bytes.take<std::uint8_t>() % 5];
  do value["cloths"].push_back(cloth_of(bytes));
  while (!bytes.empty() && value["cloths"].size() < 3);
  const Result<scene::Document> document = scene::validate(value);
  if (!document) {
    fuzz::require_pointer(document.error());
    return 0;
  }
  fuzz::require_model(document->scene);
  const Result<model::Model> model = model::build(document->scene);
  if (!model) return 0;
  require_exports(*model);
  if (document->scene.solver.method == scene::Method::pbd)
    for (const model::PbdStiffness& of : model::pbd_stiffness(*model, document->scene))
      for (const std::optional<double>& share : of)
        fuzz::require(!share || (*share >= 0.0 && *share <= 1.0), "PBD's stiffness is a share");
  return 0;
}
