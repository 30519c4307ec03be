// What `chart`, `stability`, `choose` and `simplify` print on stdout.
#pragma once

#include <string>
#include <vector>

#include "server/lab/measure/setting.h"

namespace clothlab::cli {

/// Prints rows of cells on stdout, in columns as wide as their widest cell and two blanks apart.
void print_table(const std::vector<std::vector<std::string>>& rows);
/// Prints each text of `notes` that is not empty as "note: ..." on stdout.
void print_notes(const std::vector<std::string>& notes);
/// Prints "WHAT, 1 s simulated on llvmpipe (...)", followed by ", NOT COMPLETE" unless `complete`.
void print_heading(const std::string& what, double time, const std::string& renderer, bool complete);
/// The --set options that make a command step a scene with `setting`.
std::string set_options(const lab::Setting& setting);

}  // namespace clothlab::cli
