// Any bytes as an .obj, .ply, .glb or .gltf file, mended, strictly and of one part: refused with a complete
// error, or a sound mesh that a scene can name and a model be built of.
#include <cmath>

#include "tests/fuzz/document.h"

using namespace clothlab;

namespace {

constexpr mesh::Limits limits{1 << 20, 2048, 2048};

void require_sound_mesh(const mesh::Mesh& mesh) {
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  fuzz::require(vertices >= 3 && vertices <= limits.vertices, "a mesh has as many vertices as allowed");
  fuzz::require(triangles >= 1 && triangles <= limits.triangles, "a mesh has as many triangles as allowed");
  fuzz::require(mesh.face_line.size() == triangles, "every triangle has a line");
  fuzz::require(mesh.texture.empty() || mesh.texture.size() == triangles,
                "all triangles have texture, or none");
  std::vector<bool> used(vertices, false);
  for (const auto& [a, b, c] : mesh.triangles) {
    fuzz::require(a < vertices && b < vertices && c < vertices, "a triangle's vertices exist");
    used[a] = used[b] = used[c] = true;
    fuzz::require(!mesh::has_no_area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]),
                  "every triangle has an area");
  }
  for (const bool is : used) fuzz::require(is, "every vertex is part of a triangle");
  for (const glm::dvec3& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
      fuzz::require(std::abs(vertex[axis]) <= mesh::largest_coordinate, "every coordinate is in range");
  for (const std::uint32_t vertex : mesh.vertex_of)
    fuzz::require(vertex < vertices || vertex == mesh::no_vertex,
                  "a vertex of the file became one of the mesh");
}

/// Has one mesh, of any name.
struct OneMesh : scene::Assets {
  explicit OneMesh(mesh::Mesh read) : shared(std::make_shared<const mesh::Mesh>(std::move(read))) {}
  Result<scene::SharedMesh> mesh(const std::string&, const mesh::Reading&) const override { return shared; }
  scene::SharedMesh shared;
};

/// A scene names the mesh, as a cloth with and without its pattern and as a body.
void require_scenes(mesh::Mesh&& mesh) {
  scene::json pattern = nullptr;
  if (!mesh.texture.empty()) pattern = "uv";
  const auto assets = std::make_shared<OneMesh>(std::move(mesh));
  const scene::json grid{{"mesh", {{"grid", {{"columns", 2}, {"rows", 2}}}}}};
  const scene::json body{{"mesh", {{"file", "fuzz.obj"}}}};
  for (const scene::json& of : {scene::json(nullptr), pattern, scene::json("body")}) {
    scene::json value{{"version", 1}};
    if (of == "body") {
      value["cloths"] = scene::json::array({grid});
      value["colliders"] = scene::json::array({body});
    } else {
      value["cloths"] = scene::json::array({{{"mesh", {{"obj", "fuzz.obj"}, {"pattern", of}}}}});
    }
    const Result<scene::Document> document = scene::validate(value, assets);
    if (document)
      fuzz::require_model(document->scene);
    else
      fuzz::require_pointer(document.error());
    if (document)
      for (const std::string& note : scene::mesh_notes(document->scene))
        fuzz::require(fuzz::is_utf8(note), "a note is UTF-8", note);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::text_of(data, size);
  const mesh::Reading mended, strict{.mend = false}, part{.node = "part"};
  bool sound = false;
  for (const mesh::Reading& reading : {strict, mended, part}) {
    Result<mesh::Mesh> mesh = mesh::read(bytes, "fuzz.obj", limits, reading);
    if (!mesh) {
      const Error& error = mesh.error();
      fuzz::require_complete(error);
      fuzz::require(error.where.starts_with("fuzz.obj"), "an error names the file", error.where);
      fuzz::require(fuzz::is_utf8(error.what) && fuzz::is_utf8(error.remedy), "an error is UTF-8",
                    error.text());
      fuzz::require(!sound || reading == part, "what needs no mending is read as well with it", error.text());
      continue;
    }
    require_sound_mesh(*mesh);
    fuzz::require(!mesh->no_cloth || reading.mend, "what no cloth can be is refused strictly");
    sound = reading == strict;
    require_scenes(std::move(*mesh));
  }
  return 0;
}
