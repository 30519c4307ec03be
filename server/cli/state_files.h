// What `--out` writes: the final state, or one sample after another, as OBJ, PLY or PC2 (point cache 2).
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/sim/simulation.h"

namespace clothlab::cli {

/// An error unless a file can be made or replaced at `path`; touches nothing.
Status check_writable(const std::string& option, const std::string& path);

/// Writes the whole file.
Status write_file(const std::string& path, const std::string& bytes);

class StateFiles {
 public:
  /// `series`: `add` is called for every sample, not only for the final state. OBJ and PLY samples are then
  /// numbered (out.obj becomes out-0000.obj, out-0001.obj, ...); a PC2 file holds all of them and exists only
  /// as a series.
  static Result<StateFiles> create(const std::string& path, bool series);

  /// `comment` is one line about this state; PC2 has no room for it.
  Status add(const model::Model& model, const sim::State& state, const std::string& comment);

 private:
  enum class Format { obj, ply, pc2 };

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
