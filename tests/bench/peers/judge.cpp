// peer_judge SCENE MESH...: of each .obj file the crossings, exactly counted, the largest stretch of an edge
// over the first file's, and how deep a vertex is inside a collider [m]; a line of JSON each.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "server/model/crossings.h"

namespace {

using namespace clothlab;
using nlohmann::json;

struct Mesh {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Lines that start with "v" and "f"; what follows a slash is not needed.
Mesh read(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  Mesh mesh;
  for (std::string line, word; std::getline(file, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      glm::dvec3 at(NAN);
      for (int k = 0; k < 3; ++k)
        if (words >> word) at[k] = std::stod(word);  // "inf" and "nan" too
      mesh.vertices.push_back(at);
    } else if (word == "f") {
      std::array<std::uint32_t, 3> corners{};
      for (std::uint32_t& corner : corners) {
        words >> word;
        corner = static_cast<std::uint32_t>(std::stoul(word)) - 1;
      }
      mesh.triangles.push_back(corners);
    }
  }
  return mesh;
}

model::Surfaces surfaces_of(const Mesh& mesh) {
  model::Surfaces made;
  made.triangles = mesh.triangles;
  made.first_body_vertex = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& [p, q] : {std::array{a, b}, std::array{b, c}, std::array{c, a}})
      made.edges.push_back({std::min(p, q), std::max(p, q)});
  std::sort(made.edges.begin(), made.edges.end());
  made.edges.erase(std::unique(made.edges.begin(), made.edges.end()), made.edges.end());
  return made;
}

double largest_stretch(const model::Surfaces& surfaces, const Mesh& rest, const Mesh& now) {
  double largest = -1.0;
  for (const auto& [p, q] : surfaces.edges)
    largest = std::max(largest, glm::distance(now.vertices[p], now.vertices[q]) /
                                        glm::distance(rest.vertices[p], rest.vertices[q]) -
                                    1.0);
  return largest;
}

glm::dvec3 vector_of(const json& from) {
  return {from.at(0).get<double>(), from.at(1).get<double>(), from.at(2).get<double>()};
}

/// The deepest that a vertex is inside a sphere or behind a plane [m]; 0: none is.
double depth(const json& colliders, const Mesh& mesh) {
  double deepest = 0.0;
  for (const json& collider : colliders)
    for (const glm::dvec3& x : mesh.vertices) {
      double outside = 0.0;
      if (collider.contains("sphere")) {
        const json& sphere = collider.at("sphere");
        outside = glm::distance(x, vector_of(sphere.at("center"))) - sphere.at("radius").get<double>();
      } else {
        const json& plane = collider.at("plane");
        outside = glm::dot(x - vector_of(plane.at("point")), glm::normalize(vector_of(plane.at("normal"))));
      }
      deepest = std::max(deepest, -outside);
    }
  return deepest;
}

bool all_finite(const Mesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const glm::dvec3& x) {
    return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z);
  });
}

}  // namespace

int main(int count, char** words) try {
  const json colliders = json::parse(std::ifstream(words[1])).at("document").at("colliders");
  const Mesh rest = read(words[2]);
  const model::Surfaces surfaces = surfaces_of(rest);
  for (int i = 2; i < count; ++i) {
    const Mesh now = read(words[i]);
    if (now.vertices.size() != rest.vertices.size()) throw std::runtime_error("another cloth");
    json found = nullptr;
    if (all_finite(now))
      found = {{"crossings", model::find_crossings(surfaces, now.vertices).count},
               {"stretch", largest_stretch(surfaces, rest, now)},
               {"depth_m", depth(colliders, now)}};
    std::printf("%s\n", found.dump().c_str());
  }
} catch (const std::exception& wrong) {
  std::fprintf(stderr, "peer_judge: %s\n", wrong.what());
  return 1;
}
