#include "server/lab/measure/coarsen.h"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>

#include "server/model/model.h"
#include "server/scene/pointer.h"

namespace clothlab::lab {

namespace {

using scene::json;

// The sheet's stiffness over a spring's k, for `across` lines of `along` vertices each (see coarsen.h; for
// bend springs without the factor of 4, which cancels).
double structural_share(int across, int along) {
  return static_cast<double>(across) / (along - 1);
}
double bend_share(int across, int along) {
  return static_cast<double>(across) * (along - 2) / ((along - 1.0) * (along - 1.0));
}

/// The factor on k that keeps the sheet's stiffness from one grid to the other.
template <class Share>
double factor_of(const scene::Grid& from, const scene::Grid& to, Share share) {
  const double columns = share(from.columns, from.rows) / share(to.columns, to.rows);
  const double rows = share(from.rows, from.columns) / share(to.rows, to.columns);
  const bool by_columns = std::isfinite(columns) && columns > 0.0,
             by_rows = std::isfinite(rows) && rows > 0.0;
  if (by_columns && by_rows) return std::sqrt(columns * rows);
  return by_columns ? columns : by_rows ? rows : 1.0;
}

/// a b / (a^2 + b^2) of a cell of a x b: the sheet's shear stiffness over 2 k.
double shear_share(const scene::Grid& grid) {
  const double a = grid.width / (grid.columns - 1), b = grid.height / (grid.rows - 1);
  return a * b / (a * a + b * b);
}

/// The index, on a line of `to` vertices, of the place that has `index` on a line of `from` vertices; none:
/// no vertex is there.
std::optional<int> counterpart(int index, int from, int to) {
  const double place = static_cast<double>(index) * (to - 1) / (from - 1);
  const double whole = std::round(place);
  if (std::abs(place - whole) > 1e-9) return std::nullopt;
  return static_cast<int>(whole);
}

/// The place `at` of a pin or a weight, in the coarser grid's indices; null: no vertex is there.
json moved(const json& value, const scene::At& at, const scene::Grid& from, const scene::Grid& to) {
  if (const auto* corner = std::get_if<scene::AtCorner>(&at)) {
    const auto column = counterpart(corner->column, from.columns, to.columns);
    const auto row = counterpart(corner->row, from.rows, to.rows);
    if (!column || !row) return nullptr;
    return "corner:" + std::to_string(*column) + "," + std::to_string(*row);
  }
  if (const auto* vertex = std::get_if<scene::AtVertex>(&at)) {
    const int index = static_cast<int>(vertex->vertex);
    const auto column = counterpart(index % from.columns, from.columns, to.columns);
    const auto row = counterpart(index / from.columns, from.rows, to.rows);
    if (!column || !row) return nullptr;
    return "vertex:" + std::to_string(*row * to.columns + *column);
  }
  if (const auto* edge = std::get_if<scene::AtEdge>(&at)) {
    const bool row = edge->line == scene::AtEdge::Line::row;
    const auto index = row ? counterpart(edge->index, from.rows, to.rows)
                           : counterpart(edge->index, from.columns, to.columns);
    if (!index) return nullptr;
    return (row ? "edge:row:" : "edge:column:") + std::to_string(*index);
  }
  return value;  // a box stays where it is
}

int in_box(const scene::AtBox& box, const model::Model& model, std::size_t cloth) {
  const model::ClothRange& range = model.cloths[cloth];
  int count = 0;
  for (std::uint32_t i = range.first_vertex; i < range.first_vertex + range.vertex_count; ++i)
    if (glm::all(glm::lessThanEqual(box.minimum, model.rest_position[i])) &&
        glm::all(glm::lessThanEqual(model.rest_position[i], box.maximum)))
      ++count;
  return count;
}

/// The number of vertices of a cloth that a weight is attached to; 1 for a corner or a single vertex.
int weighted_vertex_count(const scene::At& at, const scene::Grid& grid, const model::Model& model,
                          std::size_t cloth) {
  if (const auto* edge = std::get_if<scene::AtEdge>(&at))
    return edge->line == scene::AtEdge::Line::row ? grid.columns : grid.rows;
  if (const auto* box = std::get_if<scene::AtBox>(&at)) return in_box(*box, model, cloth);
  return 1;
}

std::string pointer(std::size_t cloth, const char* list, std::size_t index) {
  return "/cloths/" + std::to_string(cloth) + "/" + list + "/" + std::to_string(index) + "/at";
}

Error no_counterpart(const std::string& where, const json& at, const scene::Grid& to) {
  return {where,
          scene::compact(at) + " is between the vertices of the coarser mesh of " +
              std::to_string(to.columns) + " x " + std::to_string(to.rows),
          "a place that is also a vertex of the coarser mesh"};
}

/// What the numbers of springs are multiplied by.
struct SpringFactors {
  double structural, shear, bend;
};
SpringFactors spring_factors(const scene::Grid& from, const scene::Grid& to) {
  return {factor_of(from, to, structural_share), shear_share(from) / shear_share(to),
          factor_of(from, to, bend_share)};
}

/// Coarsens the values that keys give the springs of cloth `index`.
void coarsen_keys(json& keys, std::size_t index, const SpringFactors& by) {
  const std::string material = "/cloths/" + std::to_string(index) + "/material/";
  for (json& key : keys) {
    const std::string of = key["of"];
    for (const auto& [name, factor] : {std::pair("structural", by.structural),
                                       {"shear", by.shear},
                                       {"bend", by.bend},
                                       {"damping", by.structural}})
      if (of == material + name)
        for (json& frame : key["at"]) frame[1] = frame[1].get<double>() * factor;
  }
}

/// Coarsens the mesh, mass, material and pins of a cloth. Its weights follow in coarsen_weights, which needs
/// the coarse vertices.
Status coarsen_cloth(json& value, const scene::Cloth& cloth, std::size_t index, const scene::Grid& to) {
  const scene::Grid& from = std::get<scene::Grid>(cloth.mesh);
  value["mesh"]["grid"]["columns"] = to.columns;
  value["mesh"]["grid"]["rows"] = to.rows;
  if (cloth.mass.kind == scene::Mass::Kind::per_vertex)
    value["mass"]["per_vertex"] = cloth.mass.value * (static_cast<double>(from.columns) * from.rows) /
                                  (static_cast<double>(to.columns) * to.rows);
  // The moduli of finite elements are the sheet's own, on any mesh.
  if (const auto* springs = std::get_if<scene::Springs>(&cloth.material)) {
    const SpringFactors by = spring_factors(from, to);
    value["material"]["structural"] = springs->structural * by.structural;
    value["material"]["shear"] = springs->shear * by.shear;
    value["material"]["bend"] = springs->bend * by.bend;
    value["material"]["damping"] = springs->damping * by.structural;
  }
  for (std::size_t i = 0; i < cloth.pins.size(); ++i) {
    json& at = value["pins"][i]["at"];
    json there = moved(at, cloth.pins[i].at, from, to);
    if (there.is_null()) return no_counterpart(pointer(index, "pins", i), at, to);
    at = std::move(there);
  }
  return ok();
}

/// Coarsens the weights of a cloth: the mass on each vertex grows so that a weight's total stays the same.
Status coarsen_weights(json& value, const scene::Cloth& cloth, std::size_t index, const scene::Grid& to,
                       const model::Model& fine, const model::Model& coarse) {
  const scene::Grid& from = std::get<scene::Grid>(cloth.mesh);
  for (std::size_t i = 0; i < cloth.weights.size(); ++i) {
    const scene::Weight& weight = cloth.weights[i];
    json& at = value["weights"][i]["at"];
    json there = moved(at, weight.at, from, to);
    const int before = weighted_vertex_count(weight.at, from, fine, index),
              after = weighted_vertex_count(weight.at, to, coarse, index);
    if (there.is_null() || after == 0) return no_counterpart(pointer(index, "weights", i), at, to);
    at = std::move(there);
    value["weights"][i]["mass"] = weight.mass * before / after;
  }
  return ok();
}

std::optional<scene::Grid> coarser(const scene::Cloth& cloth, int factor) {
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  if (!grid) return std::nullopt;
  scene::Grid to = *grid;
  to.columns = coarser_count(grid->columns, factor);
  to.rows = coarser_count(grid->rows, factor);
  if (to == *grid) return std::nullopt;
  return to;
}

/// Appends to `result` the positions [m] of the vertices of `fine`, bilinear between the vertices of `coarse`
/// on the same rectangle.
void interpolate(const scene::Grid& fine, const scene::Grid& coarse, const glm::vec3* position,
                 std::vector<glm::dvec3>& result) {
  const auto at = [&](int column, int row) { return glm::dvec3(position[row * coarse.columns + column]); };
  for (int row = 0; row < fine.rows; ++row) {
    const double v = static_cast<double>(row) * (coarse.rows - 1) / (fine.rows - 1);
    const int r = std::min(static_cast<int>(v), coarse.rows - 2);
    for (int column = 0; column < fine.columns; ++column) {
      const double u = static_cast<double>(column) * (coarse.columns - 1) / (fine.columns - 1);
      const int c = std::min(static_cast<int>(u), coarse.columns - 2);
      const double s = u - c, t = v - r;
      result.push_back((1 - t) * ((1 - s) * at(c, r) + s * at(c + 1, r)) +
                       t * ((1 - s) * at(c, r + 1) + s * at(c + 1, r + 1)));
    }
  }
}

}  // namespace

int coarser_count(int count, int factor) {
  return std::max(2, static_cast<int>(std::lround(static_cast<double>(count - 1) / factor)) + 1);
}

Result<scene::Document> coarsen(const scene::Document& document, int factor) {
  const std::vector<scene::Cloth>& cloths = document.scene.cloths;
  json value = document.value;
  bool any = false, any_grid = false;
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    any_grid = any_grid || std::holds_alternative<scene::Grid>(cloths[i].mesh);
    const std::optional<scene::Grid> to = coarser(cloths[i], factor);
    if (!to) continue;
    any = true;
    if (std::holds_alternative<scene::Scatter>(cloths[i].start))
      return Error{"/cloths/" + std::to_string(i) + "/start",
                   "it scatters vertex by vertex, so that a coarser cloth starts elsewhere",
                   "another start, or none"};
    value["cloths"][i]["weights"] = json::array();
    if (Status done = coarsen_cloth(value["cloths"][i], cloths[i], i, *to); !done) return done.error();
    if (std::holds_alternative<scene::Springs>(cloths[i].material))
      coarsen_keys(value["keys"], i, spring_factors(std::get<scene::Grid>(cloths[i].mesh), *to));
  }
  if (!any)
    return Error{"/cloths",
                 any_grid ? "the grids have too few vertices" : "triangle meshes are not made coarser",
                 any_grid ? "a finer grid" : "a grid"};
  Result<scene::Document> without_weights = scene::validate(value, document.assets);
  if (!without_weights) return without_weights;
  const Result<model::Model> fine = model::build(document.scene);
  if (!fine) return fine.error();
  const Result<model::Model> coarse = model::build(without_weights->scene);
  if (!coarse) return coarse.error();
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    const std::optional<scene::Grid> to = coarser(cloths[i], factor);
    if (!to) continue;
    value["cloths"][i]["weights"] = document.value["cloths"][i]["weights"];
    if (Status done = coarsen_weights(value["cloths"][i], cloths[i], i, *to, *fine, *coarse); !done)
      return done.error();
  }
  return scene::validate(std::move(value), document.assets);
}

std::vector<glm::dvec3> at_fine_vertices(const scene::Scene& fine, const scene::Scene& coarse,
                                         const std::vector<glm::vec3>& position) {
  std::vector<glm::dvec3> result;
  const glm::vec3* first = position.data();
  for (std::size_t i = 0; i < fine.cloths.size(); ++i) {
    const auto* from = std::get_if<scene::Grid>(&fine.cloths[i].mesh);
    if (!from) {
      const std::size_t count = std::get<scene::TriangleMesh>(fine.cloths[i].mesh).vertices.size();
      result.insert(result.end(), first, first + count);
      first += count;
      continue;
    }
    const scene::Grid& to = std::get<scene::Grid>(coarse.cloths[i].mesh);
    interpolate(*from, to, first, result);
    first += static_cast<std::size_t>(to.columns) * static_cast<std::size_t>(to.rows);
  }
  return result;
}

}  // namespace clothlab::lab
