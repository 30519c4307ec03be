#include "server/cli/state_files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "server/base/text.h"
#include "server/model/glb.h"
#include "server/model/mesh_file.h"
#include "server/model/point_cache.h"

namespace clothlab::cli {

namespace fs = std::filesystem;

Status check_writable(const std::string& option, const std::string& path) {
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  std::error_code failure;
  if (!fs::is_directory(folder, failure))
    return Error{option + " " + path, "there is no folder " + folder.string(),
                 "make it first, or name another file"};
  if (fs::is_directory(path, failure)) return Error{option + " " + path, "is a folder", "name a file"};
  const bool exists = fs::exists(path, failure);
  if (access(exists ? path.c_str() : folder.c_str(), W_OK) != 0)
    return Error{option + " " + path, std::strerror(errno), "name a file that can be written"};
  return ok();
}

void remove_older(const std::string& path) {
  std::error_code failure;
  if (!path.empty() && fs::is_regular_file(path, failure)) fs::remove(path, failure);
}

Status write_file(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return Error{path, "could not be written", "check the disk's space and the file's permissions"};
  return ok();
}

Result<StateFiles> StateFiles::create(const std::string& path, bool series) {
  const std::string extension = fs::path(path).extension().string();
  Format format = Format::obj;
  if (extension == ".ply")
    format = Format::ply;
  else if (extension == ".glb")
    format = Format::glb;
  else if (extension == ".pc2")
    format = Format::pc2;
  else if (extension != ".obj")
    return Error{"--out " + path, "unknown kind of file", "one of .obj, .ply, .glb, .pc2"};
  if (format == Format::pc2 && !series)
    return Error{"--out " + path, "a PC2 file holds a series of samples", "add --every SECONDS"};
  if (Status writable = check_writable("--out", path); !writable) return writable.error();
  return StateFiles(path, format, series);
}

std::string StateFiles::next_path() const {
  if (!series_) return path_;
  const std::string number = formatted("-%04u", samples_);
  const fs::path path(path_);
  return (path.parent_path() / (path.stem().string() + number + path.extension().string())).string();
}

Status StateFiles::add(const model::Model& model, const scene::Scene& scene, const sim::State& state,
                       const std::string& comment) {
  Status written = ok();
  if (format_ == Format::pc2)
    written = add_to_point_cache(state);
  else if (format_ == Format::ply)
    written = write_file(next_path(), ply_bytes(model, state.position, comment));
  else if (format_ == Format::glb)
    written = write_file(next_path(), glb_bytes(model, scene, state.position, comment));
  else
    written = write_file(next_path(), obj_text(model, state.position, comment));
  ++samples_;
  return written;
}

Status StateFiles::add_to_point_cache(const sim::State& state) {
  const auto points = static_cast<std::uint32_t>(state.position.size());
  if (samples_ == 0)
    if (Status created = write_file(path_, model::point_cache_header(points, 0)); !created) return created;
  // The header is rewritten with every sample, so that its count is right even if the run ends early.
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  const std::size_t sample_bytes = points * sizeof(glm::vec3);
  file.seekp(static_cast<std::streamoff>(model::point_cache_header_bytes + samples_ * sample_bytes));
  file.write(reinterpret_cast<const char*>(state.position.data()),
             static_cast<std::streamsize>(sample_bytes));
  file.seekp(0);
  const std::string header = model::point_cache_header(points, samples_ + 1);
  file.write(header.data(), static_cast<std::streamsize>(header.size()));
  file.close();
  if (!file) return Error{path_, "could not be written", "check the disk's space and the file's permissions"};
  return ok();
}

}  // namespace clothlab::cli
