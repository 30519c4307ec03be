#include "server/sim/coarse_factor.h"

#include "server/sim/patch_matrix.h"

namespace clothlab::sim {

namespace {

/// Unknowns of a group.
struct Span {
  std::size_t first, begin, end;
  explicit Span(const model::Dissection::Group& group)
      : first(group.first * patch_unknowns),
        begin(group.begin * patch_unknowns),
        end(group.end * patch_unknowns) {}
  std::size_t rows() const { return end - begin; }
  std::size_t columns() const { return end - first; }
};

/// Number of fours, counted from 0 on, in which the numbers from `begin` to `end` lie.
std::size_t fours(std::size_t begin, std::size_t end) {
  return (end + 3) / 4 - begin / 4;
}

}  // namespace

FactorLayout factor_layout(const model::Dissection& dissection) {
  FactorLayout layout;
  for (const model::Dissection::Group& group : dissection.groups) {
    const Span span(group);
    layout.rows.push_back(static_cast<std::uint32_t>(layout.texels));
    layout.texels += fours(span.first, span.end) * span.rows();
    layout.columns.push_back(static_cast<std::uint32_t>(layout.texels));
    layout.texels += fours(span.begin, span.end) * span.columns();
  }
  return layout;
}

std::vector<float> laid_out(const std::vector<std::vector<double>>& factor,
                            const model::Dissection& dissection, const FactorLayout& layout) {
  std::vector<float> texels(4 * layout.texels, 0.0F);
  for (std::size_t k = 0; k < factor.size(); ++k) {
    const Span span(dissection.groups[k]);
    for (std::size_t column = span.first; column < span.end; ++column)
      for (std::size_t row = span.begin; row < span.end; ++row) {
        const auto number =
            static_cast<float>(factor[k][(column - span.first) * span.rows() + row - span.begin]);
        const std::size_t in_rows = (column / 4 - span.first / 4) * span.rows() + row - span.begin;
        const std::size_t in_columns = (row / 4 - span.begin / 4) * span.columns() + column - span.first;
        texels[4 * (layout.rows[k] + in_rows) + column % 4] = number;
        texels[4 * (layout.columns[k] + in_columns) + row % 4] = number;
      }
  }
  return texels;
}

}  // namespace clothlab::sim
