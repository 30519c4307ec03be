// From the polygons of a file to a mesh that can be simulated.
#include <algorithm>

#include "server/base/disjoint_sets.h"
#include "server/mesh/open_places.h"
#include "server/mesh/raw.h"
#include "server/mesh/sides.h"

namespace clothlab::mesh {

namespace {

using glm::dvec3;
using Index = std::uint32_t;

class Assembly {
 public:
  Assembly(const Raw& raw, const Joined& one)
      : raw_(raw), one_(one), first_(one.first), mended_(raw.mended) {}

  Result<Mesh> run() {
    if (raw_.vertices.empty() || raw_.faces.empty()) return empty();
    mesh_.line_word = raw_.line_word;
    mesh_.no_cloth = raw_.no_cloth;
    mesh_.part_names = raw_.parts;
    if (const Status cut = make_triangles(); !cut) return cut.error();
    if (const Status single = leave_doubles_out(); !single) return single.error();
    if (mesh_.triangles.empty()) return empty();
    drop_unused();
    if (raw_.mend && divide_edges(mesh_, one_.reach, raw_, mended_))
      if (const Status single = leave_doubles_out(); !single) return single.error();
    const std::vector<Side> sides = sides_of(mesh_.triangles);
    if (const Status turned = turn_to_one_side(sides); !turned) return turned.error();
    count_parts();
    if (raw_.mend) mesh_.notes = mended_.notes();
    for (std::string& note : notes_of(open_places(mesh_.vertices, mesh_.triangles, sides),
                                      [&](std::size_t triangle) { return mesh_.place_of(triangle); }))
      mesh_.notes.push_back(std::move(note));
    return std::move(mesh_);
  }

 private:
  /// There are no triangles: what was mended may be why.
  Error empty() const {
    if (raw_.no_cloth) return *raw_.no_cloth;
    std::string what = std::to_string(raw_.vertices.size()) + " vertices and " +
                       std::to_string(raw_.faces.size()) + " faces";
    if (raw_.mend)
      for (const std::string& note : mended_.notes()) what += "; " + note;
    return Error{raw_.name, what, "a mesh: vertices, and faces with an area between them"};
  }

  Status make_triangles() {
    for (Index i = 0; i < first_.size(); ++i) mesh_.merged += first_[i] != i;
    for (const Index i : one_.welded) mended_.add(Fault::welded, "vertex " + std::to_string(i));
    const bool textured = std::all_of(raw_.corners.begin(), raw_.corners.end(),
                                      [](const Corner& corner) { return corner.texture != no_texture; });
    mesh_.triangles.reserve(raw_.triangles);
    mesh_.face_line.reserve(raw_.triangles);
    if (textured) mesh_.texture.reserve(raw_.triangles);
    for (const Face& face : raw_.faces)
      if (const Status cut = cut_face(face, textured); !cut) return cut.error();
    mesh_.vertex_of = first_;
    return ok();
  }

  Status cut_face(const Face& face, bool textured) {
    const auto mend = [&](Fault fault) { mended_.add(fault, raw_.place(face.line)); };
    const Corner* of = raw_.corners.data() + face.first;
    std::vector<Corner> left;
    for (Index i = 0; i < face.count; ++i)
      if (!raw_.mend || first_[of[i].vertex] != first_[of[(i + 1) % face.count].vertex])
        left.push_back(of[i]);
    if (left.size() < 3) return mend(Fault::no_area), ok();
    if (left.size() < face.count) mend(Fault::corner_twice);
    corners_.clear();
    sorted_.clear();
    for (const Corner& corner : left) {
      corners_.push_back(raw_.vertices[corner.vertex]);
      sorted_.push_back(first_[corner.vertex]);
    }
    std::sort(sorted_.begin(), sorted_.end());
    if (!raw_.mend && std::adjacent_find(sorted_.begin(), sorted_.end()) != sorted_.end())
      return raw_.error(face.line, "a face with two corners at the same place",
                        "corners at different places");
    cut_.clear();
    const std::string wrong = triangulate(corners_, cut_, budget_);
    if (!wrong.empty()) {
      if (!raw_.mend)
        return raw_.error(face.line, wrong, "a polygon with an area, cut into triangles if need be");
      cut_.clear();
      triangulate_folded(corners_, cut_, budget_);
    }
    bool some = false, flat = false;
    for (const auto& [a, b, c] : cut_) {
      const std::array<Index, 3> one{first_[left[a].vertex], first_[left[b].vertex], first_[left[c].vertex]};
      const bool flat_as_written = has_no_area(corners_[a], corners_[b], corners_[c]);
      if (flat_as_written || (raw_.mend && is_flat_now(one))) {
        if (!raw_.mend)
          return raw_.error(face.line, "a triangle without area (its corners are in line)",
                            "triangles with an area");
        flat = true;
        continue;
      }
      some = true;
      mesh_.triangles.push_back(one);
      mesh_.face_line.push_back(face.line);
      if (textured)
        mesh_.texture.push_back(
            {raw_.texture[left[a].texture], raw_.texture[left[b].texture], raw_.texture[left[c].texture]});
    }
    if (some && !wrong.empty()) mend(Fault::folded);
    if (!some || (flat && wrong.empty())) mend(Fault::no_area);
    return ok();
  }

  /// With its corners where they are once vertices are joined.
  bool is_flat_now(const std::array<Index, 3>& one) const {
    return one[0] == one[1] || one[1] == one[2] || one[2] == one[0] ||
           has_no_area(raw_.vertices[one[0]], raw_.vertices[one[1]], raw_.vertices[one[2]]);
  }

  void drop_unused() {
    constexpr Index used = 1;
    std::vector<Index> number(raw_.vertices.size(), 0);
    for (const auto& triangle : mesh_.triangles)
      for (const Index corner : triangle) number[corner] = used;
    Index next = 0;
    for (Index i = 0; i < number.size(); ++i) {
      if (number[i] == 0 && mesh_.vertex_of[i] == i) {
        ++mesh_.unused;
        if (!raw_.part) mended_.add(Fault::unused, "vertex " + std::to_string(i));
      }
      if (number[i] == used) mesh_.vertices.push_back(raw_.vertices[i]);
      number[i] = number[i] == used ? next++ : no_vertex;
    }
    for (auto& triangle : mesh_.triangles)
      for (Index& corner : triangle) corner = number[corner];
    for (Index& vertex : mesh_.vertex_of) vertex = number[vertex];
  }

  /// Of triangles with the same corners the first stays.
  Status leave_doubles_out() {
    std::vector<std::pair<std::array<Index, 3>, Index>> sorted;
    sorted.reserve(mesh_.triangles.size());
    for (Index i = 0; i < mesh_.triangles.size(); ++i) {
      sorted.emplace_back(mesh_.triangles[i], i);
      std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<Index> doubled;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      if (sorted[i].first != sorted[i - 1].first) continue;
      if (!raw_.mend)
        return raw_.error(mesh_.face_line[sorted[i].second],
                          "a triangle at the same place as that of " + mesh_.place_of(sorted[i - 1].second),
                          "each triangle once: layers of cloth need a distance between them");
      doubled.push_back(sorted[i].second);
    }
    std::sort(doubled.begin(), doubled.end());
    for (const Index triangle : doubled) mended_.add(Fault::doubled, mesh_.place_of(triangle));
    if (doubled.empty()) return ok();
    const auto keep_others = [&](auto& list) {
      if (list.empty()) return;
      std::size_t next = 0;
      auto left_out = doubled.begin();
      for (Index i = 0; i < list.size(); ++i) {
        if (left_out != doubled.end() && *left_out == i)
          ++left_out;
        else
          list[next++] = list[i];
      }
      list.resize(next);
    };
    keep_others(mesh_.triangles);
    keep_others(mesh_.face_line);
    keep_others(mesh_.texture);
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
            const Error wrong =
                raw_.error(mesh_.face_line[next.triangle],
                           "a surface with one side only, like a Moebius band, which closes here",
                           "a surface with two sides");
            if (!raw_.mend) return wrong;
            if (!mesh_.no_cloth) mesh_.no_cloth = wrong;
            if (at < next.triangle)  // each edge is seen from both sides
              mended_.add(Fault::one_sided, mesh_.place_of(next.triangle));
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
    DisjointSets joined(mesh_.vertices.size());
    for (const auto& [a, b, c] : mesh_.triangles) {
      joined.join(a, b);
      joined.join(a, c);
    }
    for (Index i = 0; i < mesh_.vertices.size(); ++i) mesh_.parts += joined.find(i) == i;
  }

  const Raw& raw_;
  const Joined& one_;
  const std::vector<Index>& first_;
  Mending mended_;
  Mesh mesh_;
  std::size_t budget_ = 200'000'000;  // of cutting polygons: about half a second
  std::vector<dvec3> corners_;        // of the face that is cut
  std::vector<std::array<Index, 3>> cut_;
  std::vector<Index> sorted_;
};

}  // namespace

Result<Mesh> assemble(const Raw& raw) {
  const Joined near = joined(raw, true);
  Result<Mesh> mesh = Assembly(raw, near).run();
  const auto whole = [&](const Result<Mesh>& of) { return of && (!of->no_cloth || raw.no_cloth); };
  if (whole(mesh)) return mesh;
  // What is a mesh as it is written is not refused for what joining would make of it.
  const Joined exact = joined(raw, false);
  if (near.first == exact.first) return mesh;
  Result<Mesh> as_written = Assembly(raw, exact).run();
  return mesh && !whole(as_written) ? std::move(mesh) : std::move(as_written);
}

}  // namespace clothlab::mesh
