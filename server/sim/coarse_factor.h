// How shaders/methods/implicit_step.comp finds the inverse factor of the coarse level's matrix
// (patch_matrix.h), by rows and by columns. Neighbouring threads read neighbouring texels: of rows four
// columns at a time, of columns four rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/model/dissection.h"

namespace clothlab::sim {

/// Where the rows of each group begin, and its columns, in texels.
struct FactorLayout {
  std::vector<std::uint32_t> rows, columns;  ///< [group]
  std::size_t texels = 0;
};

FactorLayout factor_layout(const model::Dissection& dissection);

/// The texels, four numbers each. `factor`: of PatchMatrix::inverse_factor; if it is empty all numbers are 0.
std::vector<float> laid_out(const std::vector<std::vector<double>>& factor,
                            const model::Dissection& dissection, const FactorLayout& layout);

}  // namespace clothlab::sim
