// Reading .glb and .gltf files: buffers, accessors, nodes, parts by name, and what is said of files that are
// none.
#include <cstring>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "server/base/base64.h"
#include "server/mesh/mesh.h"
#include "server/model/glb.h"
#include "server/model/model.h"
#include "server/scene/document.h"
#include "tests/catch.h"
#include "tests/mesh_area.h"

using namespace clothlab;
using nlohmann::json;

namespace {

constexpr mesh::Limits limits{1 << 20, 1000, 2000};

template <class T>
std::string bytes_of(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

/// A file that grows by arrays.
struct Gltf {
  json document = {{"asset", {{"version", "2.0"}}},
                   {"scene", 0},
                   {"scenes", json::array({{{"nodes", json::array()}}})},
                   {"nodes", json::array()},
                   {"meshes", json::array()},
                   {"accessors", json::array()},
                   {"bufferViews", json::array()}};
  std::string buffer;

  std::size_t view(const std::string& bytes, std::size_t stride = 0) {
    json added = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride) added["byteStride"] = stride;
    document["bufferViews"].push_back(added);
    buffer += bytes;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    return document["bufferViews"].size() - 1;
  }
  std::size_t accessor(const json& of) {
    document["accessors"].push_back(of);
    return document["accessors"].size() - 1;
  }
  template <class T>
  std::size_t array(const std::vector<T>& numbers, int component, const char* type, std::size_t components) {
    return accessor({{"bufferView", view(bytes_of(numbers))},
                     {"componentType", component},
                     {"count", numbers.size() / components},
                     {"type", type}});
  }
  std::size_t places(const std::vector<float>& numbers) { return array(numbers, 5126, "VEC3", 3); }
  /// A node of the scene with a mesh of one primitive.
  json& node(const json& primitive, const char* name = nullptr) {
    document["meshes"].push_back({{"primitives", json::array({primitive})}});
    document["nodes"].push_back({{"mesh", document["meshes"].size() - 1}});
    if (name) document["nodes"].back()["name"] = name;
    document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
    return document["nodes"].back();
  }

  std::string text() const {
    json whole = document;
    whole["buffers"] =
        json::array({{{"byteLength", buffer.size()},
                      {"uri", "data:application/octet-stream;base64," +
                                  to_base64(std::as_bytes(std::span(buffer.data(), buffer.size())))}}});
    return whole.dump();
  }
  std::string beside(const std::string& uri) const {
    json whole = document;
    whole["buffers"] = json::array({{{"byteLength", buffer.size()}, {"uri", uri}}});
    return whole.dump();
  }
  std::string glb() const {
    json whole = document;
    whole["buffers"] = json::array({{{"byteLength", buffer.size()}}});
    std::string head = whole.dump();
    head.resize((head.size() + 3) / 4 * 4, ' ');
    const auto size = [](std::size_t number) { return static_cast<std::uint32_t>(number); };
    return "glTF" +
           bytes_of<std::uint32_t>(
               {2, size(28 + head.size() + buffer.size()), size(head.size()), 0x4e4f534a}) +
           head + bytes_of<std::uint32_t>({size(buffer.size()), 0x004e4942}) + buffer;
  }
};

const std::vector<float> square_places{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

/// A square, its indices of this kind.
template <class Index>
Gltf square(int component) {
  Gltf file;
  const std::size_t places = file.places(square_places);
  file.node({{"attributes", {{"POSITION", places}}},
             {"indices", file.array(std::vector<Index>{0, 1, 2, 0, 2, 3}, component, "SCALAR", 1)}},
            "sheet");
  return file;
}

mesh::Mesh read(const std::string& bytes, const std::string& node = "") {
  Result<mesh::Mesh> mesh = mesh::read(bytes, "a.glb", limits, {.node = node});
  if (!mesh) FAIL(mesh.error().text());
  return *mesh;
}

void check_refused(const std::string& bytes, const std::string& what, const mesh::Reading& reading = {}) {
  const Result<mesh::Mesh> mesh = mesh::read(bytes, "a.glb", limits, reading);
  REQUIRE_FALSE(mesh);
  INFO(mesh.error().text());
  CHECK(mesh.error().where.find("a.glb") == 0);
  CHECK(mesh.error().what.find(what) != std::string::npos);
  CHECK_FALSE(mesh.error().remedy.empty());
}

}  // namespace

TEST_CASE("a glTF file is read with indices of every width, in one file and with a buffer beside it") {
  for (const std::string& bytes : {square<std::uint8_t>(5121).glb(), square<std::uint16_t>(5123).glb(),
                                   square<std::uint32_t>(5125).glb(), square<std::uint16_t>(5123).text()}) {
    const mesh::Mesh mesh = read(bytes);
    CHECK(mesh.vertices.size() == 4);
    CHECK(mesh.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
    CHECK(mesh.notes.empty());
  }
  const Gltf file = square<std::uint16_t>(5123);
  const auto beside = [&](const std::string& name) -> Result<std::string> {
    if (name == "the mesh.bin") return file.buffer;
    return Error{name, "no such file", "another"};
  };
  CHECK(mesh::read(file.beside("the%20mesh.bin"), "a.gltf", limits, {}, beside)->triangles.size() == 2);
  CHECK_FALSE(mesh::read(file.beside("other.bin"), "a.gltf", limits, {}, beside));
  CHECK(mesh::read(file.beside("a.bin"), "a.gltf", limits).error().what.find("which is not in the file") !=
        std::string::npos);
}

TEST_CASE("lists, strips and fans of triangles, with and without indices, have one side outside") {
  const std::vector<float> zigzag{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
  for (const auto& [mode, places, count] :
       {std::tuple{5, zigzag, 3u}, {6, square_places, 2u}, {4, square_places, 1u}}) {
    Gltf file;
    file.node({{"attributes", {{"POSITION", file.places(places)}}}, {"mode", mode}});
    const mesh::Mesh mesh = read(file.glb());
    CHECK(mesh.triangles.size() == count);
    CHECK(mesh.flipped == 0);
    CHECK(test::area_of(mesh) == Approx(0.5 * count));
  }
  Gltf lines = square<std::uint16_t>(5123);
  lines.document["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  CHECK(read(lines.glb()).triangles.size() == 2);
}

TEST_CASE("nodes are where their transforms and those above put them, mirrored ones with their outside") {
  Gltf file = square<std::uint16_t>(5123);
  file.document["nodes"][0]["translation"] = {0, 0, 1};
  file.document["nodes"].push_back({{"children", {0}},
                                    {"scale", {2, 2, 2}},
                                    {"rotation", {0, 0.70710678118654752, 0, 0.70710678118654752}}});
  file.document["nodes"].push_back(
      {{"children", {1}}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1}}});
  file.document["scenes"][0]["nodes"] = {2};
  const mesh::Mesh mesh = read(file.glb());
  // (1, 0, 0): to (1, 0, 1), doubled, a quarter turn about y to (2, 0, -2), mirrored and moved along x.
  CHECK(glm::distance(mesh.vertices[1], glm::dvec3(8, 0, -2)) < 1e-6);
  CHECK(test::area_of(mesh) == Approx(4.0));
  CHECK(mesh.triangles[0] == std::array<std::uint32_t, 3>{0, 2, 1});
}

TEST_CASE("sparse accessors replace what they name, and numbers that are shares are read as such") {
  Gltf file;
  const std::size_t indices = file.view(bytes_of<std::uint16_t>({2})),
                    values = file.view(bytes_of<float>({3, 3, 0}));
  const std::size_t places = file.places(square_places);
  file.document["accessors"][places]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  file.node({{"attributes", {{"POSITION", places}}}, {"mode", 6}});
  CHECK(read(file.glb()).vertices[2] == glm::dvec3(3, 3, 0));

  Gltf packed;  // of 8 bytes each, of which 6 count
  const std::size_t at = packed.view(bytes_of<std::int16_t>({0, 0, 0, 9, 32767, 0, 0, 9, 0, 32767, 0, 9}), 8);
  packed.node({{"attributes",
                {{"POSITION", packed.accessor({{"bufferView", at},
                                               {"componentType", 5122},
                                               {"normalized", true},
                                               {"count", 3},
                                               {"type", "VEC3"}})}}}});
  CHECK(read(packed.glb()).vertices == std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST_CASE("a skinned mesh is in the pose of its joints, wherever its own node is") {
  Gltf file = square<std::uint16_t>(5123);
  json& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      file.array(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] =
      file.array(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, .5, .5, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  std::vector<float> inverse(32, 0.0f);
  for (std::size_t i = 0; i < 32; i += 16)
    for (std::size_t k = 0; k < 4; ++k) inverse[i + 5 * k] = 1.0f;
  inverse[16 + 12] = -1.0f;  // the second joint was at x = 1 when it was bound
  file.document["skins"] =
      json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", file.array(inverse, 5126, "MAT4", 16)}}});
  file.document["nodes"][0]["skin"] = 0;
  file.document["nodes"][0]["translation"] = {100, 0, 0};
  file.document["nodes"].push_back({{"translation", {0, 0, 5}}});
  file.document["nodes"].push_back({{"translation", {3, 0, 5}}});
  const mesh::Mesh mesh = read(file.glb());
  CHECK(mesh.vertices[0] == glm::dvec3(0, 0, 5));
  CHECK(mesh.vertices[2] == glm::dvec3(2, 1, 5));  // half of it at 1, half at 3
}

TEST_CASE("one node, object or group of a file is read by its name, with what is below it") {
  Gltf file = square<std::uint16_t>(5123);
  file.node({{"attributes", {{"POSITION", file.places({5, 0, 0, 6, 0, 0, 5, 1, 0})}}}}, "button");
  file.document["nodes"].push_back({{"name", "jacket"}, {"children", {1}}});
  file.document["scenes"][0]["nodes"] = {0, 2};
  CHECK(read(file.glb()).triangles.size() == 3);
  for (const char* name : {"button", "jacket"}) {
    const mesh::Mesh mesh = read(file.glb(), name);
    CHECK(mesh.triangles.size() == 1);
    CHECK(mesh.vertices[0].x == 5.0);
    CHECK(mesh.notes.empty());
  }
  check_refused(file.glb(), "no object, group or node \"hat\"", {.node = "hat"});
  CHECK(mesh::read(file.glb(), "a", limits, {.node = "hat"}).error().remedy ==
        "one of \"sheet\", \"jacket\", \"button\"");

  const std::string obj =
      "o left sleeve\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng cuff seam\nf 1 2 3\no right\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf "
      "4 5 6\n";
  for (const auto& [name, x] :
       {std::pair{"left sleeve", 0.0}, {"cuff", 0.0}, {"seam", 0.0}, {"right", 5.0}}) {
    INFO(name);
    const Result<mesh::Mesh> mesh = mesh::read(obj, "a.obj", limits, {.node = name});
    REQUIRE(mesh);
    CHECK(mesh->triangles.size() == 1);
    CHECK(mesh->vertices[0].x == x);
    CHECK(mesh->vertex_of.size() == 6);  // pins count the file's vertices
    CHECK(mesh->notes.empty());
  }
  CHECK(mesh::read(obj, "a.obj", limits, {.node = "hat"}).error().remedy ==
        "one of \"left sleeve\", \"cuff\", \"seam\", \"right\"");
}

TEST_CASE("what the program writes as .glb it reads again, with its texture as the pattern") {
  const auto document = scene::validate(
      {{"version", 1}, {"cloths", json::array({{{"mesh", {{"grid", {{"columns", 4}, {"rows", 3}}}}}}})}});
  REQUIRE(document);
  const auto model = model::build(document->scene);
  REQUIRE(model);
  std::vector<glm::vec3> places;
  for (const glm::dvec3& place : model->start_position) places.emplace_back(place);
  const mesh::Mesh mesh = read(model::glb_bytes(*model, document->scene, places, "a test"));
  REQUIRE(mesh.vertices.size() == places.size());
  for (std::size_t i = 0; i < places.size(); ++i) CHECK(glm::vec3(mesh.vertices[i]) == places[i]);
  CHECK(mesh.triangles == model->triangles);
  const std::uint32_t corner = mesh.triangles[3][1];
  CHECK(glm::distance(mesh.texture[3][1], glm::dvec2(model->texture_coordinates[corner])) < 1e-6);
}

TEST_CASE(
    "what is wrong in a glTF file is told with what is allowed, and a cut one is never read beyond its end") {
  const std::string whole = square<std::uint16_t>(5123).glb();
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(mesh::read(whole.substr(0, length), "a.glb", limits));
  const auto changed = [](const char* pointer, const json& value) {
    Gltf file = square<std::uint16_t>(5123);
    file.document[json::json_pointer(pointer)] = value;
    return file.glb();
  };
  check_refused("{}", "glTF of version");
  check_refused("[1", "no JSON object");
  check_refused(std::string(100'000, '['), "nested");
  check_refused(changed("/asset/version", "1.0"), "glTF of version \"1.0\"");
  check_refused(changed("/extensionsRequired", {"KHR_draco_mesh_compression"}), "compressed (KHR_draco");
  check_refused(changed("/bufferViews/0/extensions", {{"EXT_meshopt_compression", json::object()}}),
                "compressed (EXT_mesh");
  check_refused(
      changed("/meshes/0/primitives/0/extensions", {{"KHR_draco_mesh_compression", json::object()}}),
      "compressed");
  check_refused(changed("/extensionsRequired", {"ACME_cloth"}), "ACME_cloth");
  CHECK(mesh::read(changed("/extensionsRequired", {"KHR_materials_unlit"}), "a.glb", limits));
  check_refused(changed("/accessors/0/count", 99), "elements of 12 bytes");
  check_refused(changed("/accessors/0/count", 99999999), "99999999 elements");
  check_refused(changed("/accessors/0/count", -1), "as count");
  check_refused(changed("/accessors/0/type", "VEC2"), "VEC2");
  check_refused(changed("/accessors/0/componentType", 5124), "5124 as componentType");
  check_refused(changed("/accessors/0/bufferView", 7), "bufferViews/7");
  check_refused(changed("/bufferViews/0/byteLength", 9999), "goes beyond its buffer");
  check_refused(changed("/bufferViews/0/byteOffset", 1099511627776), "goes beyond its buffer");
  check_refused(changed("/bufferViews/0/byteStride", 4), "4 apart");
  check_refused(changed("/bufferViews/0/buffer", 1), "buffers/1");
  check_refused(changed("/meshes/0/primitives/0/mode", 7), "7 as mode");
  check_refused(changed("/meshes/0/primitives/0/attributes/POSITION", 5), "accessors/5");
  check_refused(changed("/nodes/0/mesh", 3), "meshes/3");
  check_refused(changed("/scenes/0/nodes", {4}), "nodes/4");
  check_refused(changed("/scenes/0/nodes", json::array()), "0 vertices and 0 faces");
  CHECK(read(changed("/nodes/0/children", {0})).triangles.size() == 2);  // its own child: once
  check_refused(changed("/nodes/0/scale", {1e7, 1e7, 1e7}), "as a coordinate");
  Gltf far = square<std::uint16_t>(5123);
  far.buffer[48] = 9;  // the first index
  check_refused(far.glb(), "a corner that is none of 4 vertices", {.mend = false});
  CHECK(read(far.glb()).no_cloth);
}
