// Any bytes as an .obj or .ply file: refused with a complete error, or a sound mesh that a scene can name and
// a model be built of.
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
  Result<scene::SharedMesh> mesh(const std::string&) const override { return shared; }
  scene::SharedMesh shared;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::text_of(data, size);
  Result<mesh::Mesh> mesh = mesh::read(bytes, "fuzz.obj", limits);
  if (!mesh) {
    const Error& error = mesh.error();
    fuzz::require_complete(error);
    fuzz::require(error.where.starts_with("fuzz.obj"), "an error names the file", error.where);
    fuzz::require(fuzz::is_utf8(error.what) && fuzz::is_utf8(error.remedy), "an error is UTF-8",
                  error.text());
    return 0;
  }
  require_sound_mesh(*mesh);
  scene::json pattern = nullptr;
  if (!mesh->texture.empty()) pattern = "uv";
  const auto assets = std::make_shared<OneMesh>(std::move(*mesh));
  for (const scene::json& of : {scene::json(nullptr), pattern}) {
    const Result<scene::Document> document = scene::validate(
        {{"version", 1},
         {"cloths", scene::json::array({{{"mesh", {{"obj", "fuzz.obj"}, {"pattern", of}}}}})}},
        assets);
    if (document)
      fuzz::require_model(document->scene);
    else
      fuzz::require_pointer(document.error());
  }
  return 0;
}
