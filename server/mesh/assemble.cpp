// From the polygons of a file to a mesh that can be simulated.
#include <algorithm>
#include <numeric>

#include "server/mesh/open_places.h"
#include "server/mesh/raw.h"
#include "server/mesh/sides.h"

namespace clothlab::mesh {

namespace {

using glm::dvec3;
using Index = std::uint32_t;

class Assembly {
 public:
  /// `first`: see joined().
  Assembly(const Raw& raw, const std::vector<Index>& first) : raw_(raw), first_(first) {}

  Result<Mesh> run() {
    if (raw_.vertices.empty() || raw_.faces.empty())
      return Error{raw_.name,
                   std::to_string(raw_.vertices.size()) + " vertices and " +
                       std::to_string(raw_.faces.size()) + " faces",
                   "a mesh: vertices, and faces between them"};
    mesh_.line_word = raw_.line_word;
    if (const Status cut = make_triangles(); !cut) return cut.error();
    drop_unused();
    if (const Status single = refuse_doubles(); !single) return single.error();
    const std::vector<Side> sides = sides_of(mesh_.triangles);
    if (const Status turned = turn_to_one_side(sides); !turned) return turned.error();
    count_parts();
    mesh_.notes = notes_of(open_places(mesh_.vertices, mesh_.triangles, sides),
                           [&](std::size_t triangle) { return mesh_.place_of(triangle); });
    return std::move(mesh_);
  }

 private:
  std::string place(std::size_t line) const { return raw_.line_word + (" " + std::to_string(line)); }

  Status make_triangles() {
    for (Index i = 0; i < first_.size(); ++i) mesh_.merged += first_[i] != i;
    const bool textured = std::all_of(raw_.corners.begin(), raw_.corners.end(),
                                      [](const Corner& corner) { return corner.texture != no_texture; });
    mesh_.triangles.reserve(raw_.triangles);
    mesh_.face_line.reserve(raw_.triangles);
    if (textured) mesh_.texture.reserve(raw_.triangles);
    std::size_t budget = 200'000'000;  // about half a second
    std::vector<dvec3> corners;
    std::vector<std::array<Index, 3>> cut;
    std::vector<Index> sorted;
    for (const Face& face : raw_.faces) {
      const Corner* of = raw_.corners.data() + face.first;
      corners.clear();
      sorted.clear();
      for (Index i = 0; i < face.count; ++i) {
        corners.push_back(raw_.vertices[of[i].vertex]);
        sorted.push_back(first_[of[i].vertex]);
      }
      std::sort(sorted.begin(), sorted.end());
      if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        return raw_.error(face.line, "a face with two corners at the same place",
                          "corners at different places");
      cut.clear();
      if (const std::string wrong = triangulate(corners, cut, budget); !wrong.empty())
        return raw_.error(face.line, wrong, "a polygon with an area, cut into triangles if need be");
      for (const auto& [a, b, c] : cut) {
        if (has_no_area(corners[a], corners[b], corners[c]))
          return raw_.error(face.line, "a triangle without area (its corners are in line)",
                            "triangles with an area");
        mesh_.triangles.push_back({first_[of[a].vertex], first_[of[b].vertex], first_[of[c].vertex]});
        mesh_.face_line.push_back(face.line);
        if (textured)
          mesh_.texture.push_back(
              {raw_.texture[of[a].texture], raw_.texture[of[b].texture], raw_.texture[of[c].texture]});
      }
    }
    mesh_.vertex_of = first_;
    return ok();
  }

  void drop_unused() {
    constexpr Index used = 1;
    std::vector<Index> number(raw_.vertices.size(), 0);
    for (const auto& triangle : mesh_.triangles)
      for (const Index corner : triangle) number[corner] = used;
    Index next = 0;
    for (Index i = 0; i < number.size(); ++i) {
      if (number[i] == 0 && mesh_.vertex_of[i] == i) ++mesh_.unused;
      if (number[i] == used) mesh_.vertices.push_back(raw_.vertices[i]);
      number[i] = number[i] == used ? next++ : no_vertex;
    }
    for (auto& triangle : mesh_.triangles)
      for (Index& corner : triangle) corner = number[corner];
    for (Index& vertex : mesh_.vertex_of) vertex = number[vertex];
  }

  Status refuse_doubles() const {
    std::vector<std::pair<std::array<Index, 3>, Index>> sorted;
    sorted.reserve(mesh_.triangles.size());
    for (Index i = 0; i < mesh_.triangles.size(); ++i) {
      sorted.emplace_back(mesh_.triangles[i], i);
      std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first)
        return raw_.error(
            mesh_.face_line[sorted[i].second],
            "a triangle at the same place as that of " + place(mesh_.face_line[sorted[i - 1].second]),
            "each triangle once: layers of cloth need a distance between them");
    return ok();
  }

  /// Two triangles at an edge have the same side outside if they go along it in opposite directions. Edges of
  /// three or more triangles are left aside.
  Status turn_to_one_side(const std::vector<Side>& sides) {
    constexpr Index none = 0xffffffffu;
    struct Neighbour {
      Index triangle = none;
      bool turned = false;  // it has the other side outside
    };
    std::vector<std::array<Neighbour, 3>> neighbours(mesh_.triangles.size());
    std::vector<std::uint8_t> count(mesh_.triangles.size(), 0);
    each_edge(sides, [&](std::size_t begin, std::size_t end) {
      if (end - begin != 2) return;
      const Side &a = sides[begin], &b = sides[begin + 1];
      const bool turned = a.forward == b.forward;
      neighbours[a.triangle][count[a.triangle]++] = {b.triangle, turned};
      neighbours[b.triangle][count[b.triangle]++] = {a.triangle, turned};
    });
    enum : std::uint8_t { unseen, kept, turned_over };
    std::vector<std::uint8_t> state(mesh_.triangles.size(), unseen);
    std::vector<Index> open;
    for (Index seed = 0; seed < state.size(); ++seed) {
      if (state[seed] != unseen) continue;
      state[seed] = kept;
      open.push_back(seed);
      while (!open.empty()) {
        const Index at = open.back();
        open.pop_back();
        for (std::size_t i = 0; i < count[at]; ++i) {
          const Neighbour& next = neighbours[at][i];
          const std::uint8_t wanted = (state[at] == kept) == next.turned ? turned_over : kept;
          if (state[next.triangle] == unseen) {
            state[next.triangle] = wanted;
            open.push_back(next.triangle);
          } else if (state[next.triangle] != wanted) {
            return raw_.error(mesh_.face_line[next.triangle],
                              "a surface with one side only, like a Moebius band, which closes here",
                              "a surface with two sides");
          }
        }
      }
    }
    for (std::size_t i = 0; i < state.size(); ++i) {
      if (state[i] != turned_over) continue;
      ++mesh_.flipped;
      std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
      if (!mesh_.texture.empty()) std::swap(mesh_.texture[i][1], mesh_.texture[i][2]);
    }
    return ok();
  }

  void count_parts() {
    std::vector<Index> root(mesh_.vertices.size());
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](Index i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    for (const auto& triangle : mesh_.triangles)
      for (const Index corner : {triangle[1], triangle[2]}) root[find(corner)] = find(triangle[0]);
    for (Index i = 0; i < root.size(); ++i) mesh_.parts += find(i) == i;
  }

  const Raw& raw_;
  const std::vector<Index>& first_;
  Mesh mesh_;
};

}  // namespace

Result<Mesh> assemble(const Raw& raw) {
  const std::vector<Index> first = joined(raw, true);
  Result<Mesh> mesh = Assembly(raw, first).run();
  if (mesh) return mesh;
  // What is a mesh as it is written is not refused for what joining would make of it.
  const std::vector<Index> exact = joined(raw, false);
  return first == exact ? mesh : Assembly(raw, exact).run();
}

}  // namespace clothlab::mesh
