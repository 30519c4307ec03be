// Reads the `at` of a pin or a weight: "corner:COLUMN,ROW", "vertex:N", "edge:row:N", "edge:column:N" or
// {"box": [[min], [max]]}.
#include <optional>

#include "server/scene/pointer.h"
#include "server/scene/sections.h"
#include "server/scene/vertex_numbers.h"

namespace clothlab::scene {

namespace {

const std::string at_forms =
    R"("corner:COLUMN,ROW", "vertex:N", "edge:row:N", "edge:column:N" or {"box": [[x,y,z],[x,y,z]]})";

/// The rest of `text` after `prefix`, if `text` starts with it.
std::optional<std::string> after(const std::string& text, const std::string& prefix) {
  return text.rfind(prefix, 0) == 0 ? std::optional(text.substr(prefix.size())) : std::nullopt;
}

std::optional<std::uint32_t> index_in(const std::string& text) {
  const std::optional<std::size_t> index = array_index(text, max_vertices);
  return index ? std::optional(static_cast<std::uint32_t>(*index)) : std::nullopt;
}

std::optional<At> parse_at(const std::string& text) {
  if (const auto numbers = after(text, "corner:")) {
    const std::size_t comma = numbers->find(',');
    if (comma == std::string::npos) return std::nullopt;
    const auto column = index_in(numbers->substr(0, comma)), row = index_in(numbers->substr(comma + 1));
    if (!column || !row) return std::nullopt;
    return AtCorner{static_cast<int>(*column), static_cast<int>(*row)};
  }
  if (const auto number = after(text, "vertex:")) {
    const auto vertex = index_in(*number);
    return vertex ? std::optional<At>(AtVertex{*vertex}) : std::nullopt;
  }
  for (const AtEdge::Line line : {AtEdge::Line::row, AtEdge::Line::column}) {
    const auto number = after(text, line == AtEdge::Line::row ? "edge:row:" : "edge:column:");
    const auto index = number ? index_in(*number) : std::nullopt;
    if (index) return AtEdge{line, static_cast<int>(*index)};
  }
  return std::nullopt;
}

std::string up_to(const char* what, std::size_t count) {
  return std::string(what) + " 0 to " + std::to_string(count - 1);
}

/// The number in a document is the file's; that in a scene is the mesh's. Empty if the vertex exists, else
/// what is allowed.
std::string find_vertex(AtVertex& at, const Mesh& mesh) {
  const std::size_t count = counted_vertices(mesh);
  if (at.vertex >= count) return "a vertex of this mesh: " + up_to("vertex", count);
  at.vertex = vertex_of(mesh, at.vertex);
  return at.vertex == mesh::no_vertex ? "a vertex of a face: this one is part of none, and left out" : "";
}

/// Empty if `at` lies in the mesh, else what is allowed. Boxes are checked later, by model::build.
std::string outside(const At& at, const Mesh& mesh) {
  const Grid* grid = std::get_if<Grid>(&mesh);
  if (std::holds_alternative<AtBox>(at)) return "";
  if (!grid) return "\"vertex:N\" or {\"box\": ...}: this mesh is no grid and has no rows and columns";
  const auto columns = static_cast<std::size_t>(grid->columns), rows = static_cast<std::size_t>(grid->rows);
  const std::string allowed = "a place in this grid: " + up_to("column", columns) + ", " + up_to("row", rows);
  if (const AtCorner* corner = std::get_if<AtCorner>(&at))
    return corner->column < grid->columns && corner->row < grid->rows ? "" : allowed;
  const AtEdge& edge = std::get<AtEdge>(at);
  return edge.index < (edge.line == AtEdge::Line::row ? grid->rows : grid->columns) ? "" : allowed;
}

At read_box(const Reader& at) {
  at.object({"box"});
  const Reader box = at.member("box");
  if (box.array(2, 2) != 2) return AtBox{};
  const AtBox result{box.element(0).vector(ranges::position), box.element(1).vector(ranges::position)};
  for (int axis = 0; axis < 3; ++axis)
    if (result.minimum[axis] > result.maximum[axis])
      box.fail("the smaller corner first: [[min x,y,z], [max x,y,z]]");
  return result;
}

}  // namespace

At read_at(const Reader& at, const Mesh& mesh) {
  if (at.has("box")) return read_box(at);
  std::optional<At> parsed = parse_at(at.string(at_forms));
  if (!parsed) {
    at.fail(at_forms);
    return AtVertex{};
  }
  AtVertex* vertex = std::get_if<AtVertex>(&*parsed);
  const std::string allowed = vertex ? find_vertex(*vertex, mesh) : outside(*parsed, mesh);
  if (!allowed.empty()) at.fail(allowed);
  return *parsed;
}

}  // namespace clothlab::scene
