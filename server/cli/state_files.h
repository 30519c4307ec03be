// The files of `--out`: the final state or a series of samples, as OBJ, PLY, binary glTF or PC2 (point cache
// 2).
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/sim/simulation.h"

namespace clothlab::cli {

/// Checks that a file can be made or replaced at `path`, without touching it. Errors name `option`.
Status check_writable(const std::string& option, const std::string& path);

/// Removes the file at `path`, if there is one, which this run would replace at its end: a run that fails
/// leaves none behind that is of an older one.
void remove_older(const std::string& path);

/// Makes or replaces the file at `path`, with `bytes` as its contents.
Status write_file(const std::string& path, const std::string& bytes);

class StateFiles {
 public:
  /// `series`: true if `add` is called for every sample, not only for the final state. All samples
  /// but those of a PC2 file are then numbered (out.obj becomes out-0000.obj, out-0001.obj, ...). One PC2
  /// file holds all samples, and is possible only for a series.
  static Result<StateFiles> create(const std::string& path, bool series);

  /// Writes one sample. `comment` is one line about this state; a PC2 file cannot hold it.
  Status add(const model::Model& model, const scene::Scene& scene, const sim::State& state,
             const std::string& comment);

 private:
  enum class Format { obj, ply, glb, pc2 };

  StateFiles(std::string path, Format format, bool series)
      : path_(std::move(path)), format_(format), series_(series) {}
  std::string next_path() const;
  Status add_to_point_cache(const sim::State& state);

  std::string path_;
  Format format_;
  bool series_;
  std::uint32_t samples_ = 0;
};

}  // namespace clothlab::cli
