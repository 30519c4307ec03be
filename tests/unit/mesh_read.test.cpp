// Reading .obj and .ply files: what becomes of them, and what is said of those that are no mesh.
#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>
#include <set>

#include "server/mesh/mesh.h"
#include "tests/catch.h"
#include "tests/mesh_area.h"

using namespace clothlab;

namespace {

constexpr mesh::Limits limits{1 << 20, 1000, 2000};
const mesh::Reading strict{.mend = false};

mesh::Mesh read(const std::string& text, const std::string& name = "a.obj",
                const mesh::Reading& reading = strict) {
  Result<mesh::Mesh> mesh = mesh::read(text, name, limits, reading);
  if (!mesh) FAIL(mesh.error().text());
  return *mesh;
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

struct Refusal {
  std::string text;
  const char *where, *what;
};

void check_refusals(const std::vector<Refusal>& refusals, const std::string& name) {
  for (const Refusal& refusal : refusals) {
    INFO(refusal.text.substr(0, 200));
    const Result<mesh::Mesh> mesh = mesh::read(refusal.text, name, limits, strict);
    REQUIRE_FALSE(mesh);
    INFO(mesh.error().text());
    CHECK(mesh.error().where == name + refusal.where);
    CHECK(mesh.error().what.find(refusal.what) != std::string::npos);
    CHECK_FALSE(mesh.error().remedy.empty());
  }
}

std::string ply(const std::string& format, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
         "z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         body;
}

template <class T>
void append(std::string& bytes, T value, bool big) {
  std::string one(reinterpret_cast<const char*>(&value), sizeof value);
  if (big) std::reverse(one.begin(), one.end());
  bytes += one;
}

std::string binary_square(bool big) {
  std::string bytes;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) append(bytes, x, big);
  append(bytes, std::uint8_t{4}, big);
  for (const std::int32_t i : {0, 1, 2, 3}) append(bytes, i, big);
  return bytes;
}

}  // namespace

TEST_CASE("a byte-order mark before a mesh is no part of it") {
  const std::string mark = "\xEF\xBB\xBF", faces = square + "f 1 2 3 4\n";
  CHECK(read(mark + faces).vertices == read(faces).vertices);
  CHECK(read(mark + "# a\r\n" + faces).triangles == read(faces).triangles);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n";
  for (const char* name : {"a.ply", "a"}) CHECK(read(mark + ply, name).vertices == read(ply, name).vertices);
  CHECK_FALSE(mesh::read(mark + mark + faces, "a.obj", limits));
}

TEST_CASE("an .obj file is read with every form of corner, comments, groups and lines that go on") {
  for (const char* face : {"f 1 2 3 4", "f -4 -3 -2 -1", "f 1/1 2/1 3/1 4/1", "f 1//1 2//1 3//1 4//1",
                           "f 1/1/1 2/1/1 3/1/1 4/1/1", "f 1 2 \\\n 3 4", "  f\t1 2 3 4 # all"}) {
    INFO(face);
    const mesh::Mesh mesh = read("# a square\r\nmtllib a.mtl\r\no cloth\n" + square +
                                 "vt 0.5 0.5\nvn 0 0 1\ng part\nusemtl red\ns 1\n" + face);
    CHECK(mesh.vertices.size() == 4);
    CHECK(mesh.triangles.size() == 2);
    CHECK(test::area_of(mesh) == Approx(1.0));
    CHECK(mesh.parts == 1);
  }
}

TEST_CASE("a .ply file is read as text and as bytes of either order") {
  const std::string text = ply("ascii", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  for (const std::string& file : {text, ply("binary_little_endian", binary_square(false)),
                                  ply("binary_big_endian", binary_square(true))}) {
    const mesh::Mesh mesh = read(file, "a.ply");
    CHECK(mesh.vertices == read(text, "a.ply").vertices);
    CHECK(mesh.triangles == read(text, "a.ply").triangles);
    CHECK(test::area_of(mesh) == Approx(1.0));
    for (std::size_t length = 0; length < file.size(); ++length)
      if (mesh::read(file.substr(0, length), "a.ply", limits, strict))
        CHECK(length + 1 == file.size());  // a last newline
  }
}

TEST_CASE("polygons are cut into triangles that cover them, convex or not") {
  const mesh::Mesh arrow =
      read("v 0 0 0\nv 2 -1 0\nv 0 2 0\nv -2 -1 0\nf 1 2 3 4\n");  // a dart: corner 1 is reflex
  CHECK(arrow.triangles.size() == 2);
  CHECK(test::area_of(arrow) == Approx(4.0));
  // Its shortest cut, between corners 2 and 4, would have corners 1 and 5 inside.
  const mesh::Mesh notched =
      read("v 0.2 -0.5 0\nv 1 -1 0\nv 0 10 0\nv -1 -1 0\nv -0.2 -0.5 0\nf 1 2 3 4 5\n");
  CHECK(notched.triangles.size() == 3);
  CHECK(test::area_of(notched) == Approx(10.4));
  // A convex quad is cut between corners 2 and 4, which are nearer to each other.
  for (const auto& corners : read("v 0 0 0\nv 3 0 0\nv 4 1 0\nv 0.5 1 0\nf 1 2 3 4\n").triangles)
    CHECK(std::count(corners.begin(), corners.end(), 1u) == 1);
  // A comb with two teeth, counter-clockwise.
  const mesh::Mesh comb = read(
      "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv "
      "0 3 0\n"
      "f 1 2 3 4 5 6 7 8 9 10 11 12\n");
  CHECK(comb.triangles.size() == 10);
  CHECK(test::area_of(comb) == Approx(5.0 + 3 * 2.0));
}

TEST_CASE("a vertex on a seam of the texture stays one vertex, with its own place in each panel") {
  const mesh::Mesh mesh =
      read(square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 5 5\nvt 6 6\nvt 5 6\nf 1/1 2/2 3/3\nf 1/4 3/5 4/6\n");
  CHECK(mesh.vertices.size() == 4);
  REQUIRE(mesh.texture.size() == 2);
  CHECK(mesh.texture[0][0] == glm::dvec2(0, 0));
  CHECK(mesh.texture[1][0] == glm::dvec2(5, 5));
  CHECK(read(square + "vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n").texture.empty());
}

TEST_CASE("vertices at exactly the same place are one, unused ones are left out, numbers stay the file's") {
  const mesh::Mesh mesh = read("v 9 9 9\n" + square + "v 0 0 -0\nv 1 1 0\nf 2 3 4\nf 6 7 5\n");
  CHECK(mesh.vertices.size() == 4);
  CHECK(mesh.merged == 2);
  CHECK(mesh.unused == 1);
  CHECK(mesh.parts == 1);
  CHECK(mesh.vertex_of == std::vector<std::uint32_t>{mesh::no_vertex, 0, 1, 2, 3, 0, 2});
}

namespace {

/// Two squares of 1 m, side by side along y, whose corners at the seam are `apart` in x. Each number has
/// `digits` behind the point; less than 0: as many as it takes.
std::string two_squares(double apart, int digits, double scale = 1.0) {
  std::string text;
  const auto vertex = [&](double x, double y) {
    char line[200];
    if (digits < 0)
      std::snprintf(line, sizeof line, "v %.17g %.17g 0\n", scale * x, scale * y);
    else
      std::snprintf(line, sizeof line, "v %.*f %.*f 0\n", digits, scale * x, digits, scale * y);
    text += line;
  };
  for (const double y : {0.0, 0.5, 1.0}) {
    vertex(0, y);
    vertex(1, y);
  }
  for (const double y : {0.0, 0.5, 1.0}) {
    vertex(1 + apart, y);
    vertex(2, y);
  }
  return text + "f 1 2 4 3\nf 3 4 6 5\nf 7 8 10 9\nf 9 10 12 11\n";
}

}  // namespace

TEST_CASE(
    "vertices that rounding has taken apart are one: in doubles, in floats, in the last digit of a text") {
  for (const auto& [apart, digits] :
       {std::pair{7e-17, -1}, {2.3e-16, -1}, {1.2e-7, -1}, {1e-6, 6}, {-1e-7, 7}}) {
    INFO(apart << " m apart, " << digits << " digits");
    const mesh::Mesh mesh = read(two_squares(apart, digits));
    CHECK(mesh.parts == 1);
    CHECK(mesh.vertices.size() == 9);
    CHECK(mesh.merged == 3);
    CHECK(mesh.vertex_of[6] == mesh.vertex_of[1]);
    CHECK(mesh.vertices[mesh.vertex_of[6]].x == 1.0);
    CHECK(mesh.notes.empty());
  }
  // About the origin, where a copy that should be 0 is not: 7e-17.
  std::string about_zero =
      "v -1 0 0\nv 0 0 0\nv 0 1 0\nv 7e-17 0 0\nv 1 0 0\nv -7e-17 1 1e-18\nf 1 2 3\nf 4 5 6\n";
  CHECK(read(about_zero).parts == 1);
}

TEST_CASE(
    "vertices that are apart by more than rounding stay two, and where borders all but meet that is told by "
    "line") {
  for (const auto& [apart, digits] : {std::pair{2e-6, -1}, {1e-4, 4}, {1e-5, 6}, {3e-4, -1}}) {
    INFO(apart << " m apart, " << digits << " digits");
    const mesh::Mesh mesh = read(two_squares(apart, digits));
    CHECK(mesh.parts == 2);
    CHECK(mesh.merged == 0);
    REQUIRE(mesh.notes.size() == 1);
    INFO(mesh.notes[0]);
    CHECK(mesh.notes[0].find("3 corners") == 0);
    CHECK(mesh.notes[0].find("line 13 and line 15") != std::string::npos);
  }
  // Layers that lie on each other: a thousandth of their sides apart, or more.
  CHECK(read(two_squares(1e-3, -1)).notes.empty());
  CHECK(read(two_squares(1e-2, -1)).parts == 2);
}

TEST_CASE(
    "layers of cloth are not joined however near they are, nor are the sides of a mesh however fine it is") {
  const std::string upper = "v 0 0 1e-8\nv 1 0 1e-8\nv 1 1 1e-8\nv 0 1 1e-8\n";
  const mesh::Mesh layers = read(square + upper + "f 1 2 3 4\nf 5 6 7 8\n");
  CHECK(layers.parts == 2);
  CHECK(layers.merged == 0);
  CHECK(layers.notes.size() == 1);
  // A fine mesh beside a far vertex, whose coordinate would make a thousand times its sides the same place.
  for (const double side : {1e-5, 1e-3}) {
    const mesh::Mesh fine =
        read(two_squares(0.0, -1, side) + "v 1e5 0 0\nv 1e5 1 0\nv 1e5 0 1\nf 13 14 15\n");
    CHECK(fine.vertices.size() == 12);
    const mesh::Mesh split =
        read(two_squares(1e-9, -1, side) + "v 1e5 0 0\nv 1e5 1 0\nv 1e5 0 1\nf 13 14 15\n");
    CHECK(split.parts == 2);
    CHECK(split.vertices.size() == 12);
  }
}

TEST_CASE("a corner on an edge that has no vertex there is told by line") {
  // The left square has an edge from (1, 0) to (1, 1); the right ones have a corner in its middle.
  const std::string right = "v 1 0.5 0\nv 2 0 0\nv 2 0.5 0\nv 2 1 0\n";
  const mesh::Mesh mesh = read(square + right + "f 1 2 3 4\nf 2 6 7 5\nf 5 7 8 3\n");
  CHECK(mesh.parts == 1);
  REQUIRE(mesh.notes.size() == 1);
  INFO(mesh.notes[0]);
  CHECK(mesh.notes[0].find("1 corner ") == 0);
  CHECK(mesh.notes[0].find("on an edge") != std::string::npos);
  CHECK(mesh.notes[0].find("line 9") != std::string::npos);
  CHECK(read(square + "v 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n").notes.empty());
}

TEST_CASE(
    "triangles given as such are joined likewise as a body, and told of as a cloth, which stays as it is") {
  const std::vector<glm::dvec3> vertices{{0, 0, 0},     {1, 0, 0}, {0, 1, 0},
                                         {1, 7e-17, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
  const Result<mesh::Mesh> body = mesh::assemble_triangles(vertices, triangles);
  REQUIRE(body);
  CHECK(body->parts == 1);
  const std::vector<std::string> notes = mesh::notes_of_triangles(vertices, triangles);
  REQUIRE(notes.size() == 1);
  INFO(notes[0]);
  CHECK(notes[0].find("2 corners") == 0);
  CHECK(notes[0].find("triangle 0 and triangle 1") != std::string::npos);
}

TEST_CASE("several parts, holes and edges of three triangles are meshes") {
  CHECK(read(square + "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3 4\nf 5 6 7\n").parts == 2);
  const mesh::Mesh fin = read(square + "v 0.5 0.5 1\nf 1 3 2\nf 1 3 4\nf 1 3 5\n");
  CHECK(fin.triangles.size() == 3);
  CHECK(fin.flipped == 0);
}

TEST_CASE("neighbours get the same side outside, their texture coordinates with them") {
  const mesh::Mesh mesh = read(square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 4/4 3/3 1/1\n");
  CHECK(mesh.flipped == 1);
  CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{3, 0, 2});
  CHECK(mesh.texture[1][1] == glm::dvec2(0, 0));
}

TEST_CASE("what is wrong in an .obj file is named with its line, what was found and what is allowed") {
  const std::string tens = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string many_vertices, many_triangles = tens;
  for (int i = 0; i < 1001; ++i) many_vertices += "v 0 0 " + std::to_string(i) + "\n";
  for (int i = 0; i < 2001; ++i) many_triangles += "f 1 2 3\n";
  std::string wide = tens + "f";
  for (int i = 0; i < 1100; ++i) wide += " 1";
  check_refusals(
      {{"", "", "0 vertices"},
       {tens, "", "0 faces"},
       {"v 0 nan 0\n", ", line 1", "\"nan\" as y"},
       {"v 0 0 inf\n", ", line 1", "\"inf\" as z"},
       {"v 0 0 1e999\n", ", line 1", "\"1e999\" as z"},
       {"v 1e7 0 0\n", ", line 1", "\"1e7\" as x"},
       {"v 1 2\n", ", line 1", "nothing as z"},
       {"v 1 2 3x\n", ", line 1", "\"3x\" as z"},
       {"v 1 2 3 4 5 6 7 8\n", ", line 1", "\"8\" after"},
       {tens + "f 1 2 4\n", ", line 4", "\"4\" as a vertex"},
       {tens + "f 1 2 0\n", ", line 4", "\"0\" as a vertex"},
       {tens + "f 1 2 -4\n", ", line 4", "\"-4\" as a vertex"},
       {tens + "f 1 2 9223372036854775808\n", ", line 4", "as a vertex"},
       {tens + "f 1 2 2.0\n", ", line 4", "\"2.0\" as a vertex"},
       {tens + "f 1/1 2/1 3/1\n", ", line 4", "\"1\" as a texture coordinate"},
       {tens + "f 1//x 2//1 3//1\n", ", line 4", "\"1//x\" as a corner"},
       {tens + "f 1 2\n", ", line 4", "a face of 2 corners"},
       {wide, ", line 4", "more than 1024 corners"},
       {tens + "f 1 2 2\n", ", line 4", "two corners at the same place"},
       {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ", line 4", "without area"},
       {"v 0 0 0\nv 1 0 0\nv 2 1e-9 0\nf 1 2 3\n", ", line 4", "without area"},
       {square + "f 1 3 2 4\n", ", line 5", "without area"},  // crosses itself, its two halves cancel
       {tens + "f 1 2 3\nf 3 1 2\n", ", line 5", "the same place as that of line 4"},
       {many_vertices, ", line 1001", "more than 1000 vertices"},
       {many_triangles, ", line 2004", "more than 2000 triangles"},
       {tens + "curv 0 1 2 3\n", ", line 4", "curved"},
       {tens + "hello\n", ", line 4", "\"hello\""},
       {std::string("\x7f"
                    "ELF\0\0",
                    6),
        ", line 1", "the byte 0x7f"},
       {std::string("v 0 0 \0\n", 8), ", line 1", "the byte 0x00"},
       {std::string(limits.bytes + 1, ' '), "", "1048577 bytes"}},
      "a.obj");
  // The Moebius band of five triangles: each shares an edge with the next, and the last, turned over, with
  // the first.
  check_refusals(
      {{"v 0 0 0\nv 3 0 1\nv 1 2 0\nv 0 1 3\nv 2 2 2\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n",
        ", line 10", "one side only"}},
      "moebius.obj");
}

TEST_CASE("what is wrong in a .ply file is named with its line or face") {
  const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  std::string many = ply("ascii", "");
  many.replace(many.find("vertex 4"), 8, "vertex 1001");
  for (int i = 0; i < 1001; ++i) many += "0 0 " + std::to_string(i) + "\n";
  std::string far = binary_square(false);
  far[far.size() - 4] = 4;  // the last index
  check_refusals(
      {{"v 0 0 0\n", ", line 1", "\"v 0 0 0\""},
       {"ply\nformat ascii 1.0\n", ", line 2", "the end of the file"},
       {"ply\nformat morse 1.0\n", ", line 2", "\"morse\""},
       {"ply\nelement vertex -1\n", ", line 2", "\"-1\" as a count"},
       {"ply\nproperty float x\n", ", line 2", "before any element"},
       {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n", ", line 5", "end_header"},
       {"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty "
        "float "
        "z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n",
        ", line 3", "99999999999 of \"vertex\""},
       {"ply\nformat binary_little_endian 1.0\nelement void 99999999999\nelement vertex 1\nproperty float "
        "x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
        "vertex_index\nend_header\n",
        ", line 3", "without properties"},
       {many, ", line 4", "1001 of \"vertex\""},
       {ply("ascii", corners + "4 0 1 2 4\n"), ", line 15", "as a vertex"},
       {ply("ascii", corners + "4 0 1 2\n"), ", line 15", "too few numbers"},
       {ply("ascii", corners + "3 0 1 2 3\n"), ", line 15", "after the last property"},
       {ply("ascii", corners + "9999 0 1 2\n"), ", line 15", "a list of"},
       {ply("ascii", "0 0 nan\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"), ", line 11", "nan"},
       {ply("ascii", corners), ", line 14", "the end of the file"},
       {ply("binary_little_endian", far), ", face 1", "as a vertex"}},
      "a.ply");
}
