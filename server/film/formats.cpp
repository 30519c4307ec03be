#include "server/film/formats.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "server/base/text.h"
#include "server/model/mesh_file.h"
#include "server/model/point_cache.h"

namespace clothlab::film {

namespace {

namespace fs = std::filesystem;

// Of a place and a normal in each frame, in .usda of up to 33 letters each.
constexpr std::uint64_t glb_bytes = 24, usda_bytes = 66, pc2_bytes = 12;
/// The weights of a .glb are a square of its frames: 16 MiB of them. Programs also make a shape of each.
constexpr std::uint32_t most_glb_frames = 2048;
constexpr std::uint64_t weight_bytes = 4;
constexpr std::uint64_t most_glb_bytes =
    0xf0000000;  ///< its lengths are of 32 bits; beside frames there is more

const std::array all{
    Format{".glb", "model/gltf-binary", most_glb_frames, write_glb,
           [](std::uint64_t frames, std::uint64_t vertices) {
             return frames * (glb_bytes * vertices + weight_bytes * frames);
           }},
    Format{".usda", "model/vnd.usda", 0, write_usda,
           [](std::uint64_t frames, std::uint64_t vertices) { return usda_bytes * frames * vertices; }},
    Format{".pc2", "application/octet-stream", 0, write_pc2,
           [](std::uint64_t frames, std::uint64_t vertices) { return pc2_bytes * frames * vertices; }},
};

Error not_written(const fs::path& path) {
  return {path.string(), "could not be written", "check the disk's space and the file's permissions"};
}

/// Has `write` put bytes into a new file, which are counted.
template <class Write>
Status into_file(const fs::path& path, Written& written, Write write) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  const Status done = write(Put([&](std::string_view bytes) {
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    written.bytes += bytes.size();
    return file ? ok() : Status(not_written(path));
  }));
  file.close();
  if (!done) return done;
  return file ? ok() : Status(not_written(path));
}

/// The mesh with the places of a frame.
Status write_obj(const Film& film, std::uint32_t frame, std::span<const glm::vec3> positions,
                 const fs::path& path, Written& written) {
  const std::string comment = "Clothlab " CLOTHLAB_VERSION ", scene " + film.title + ", frame " +
                              std::to_string(frame) + " of " + std::to_string(film.frames()) + ", " +
                              with_significant_digits(film.times[frame], 9) + " s after the first, in metres";
  return into_file(path, written, [&](const Put& put) {
    return put(model::obj_text(film.triangles, film.texture_coordinates, positions, comment));
  });
}

Status write_obj_series(const Film& film, const fs::path& path, Written& written) {
  const auto name = [&](std::uint32_t frame) {
    return path.parent_path() /
           (path.stem().string() + formatted("-%04u", frame) + path.extension().string());
  };
  written.names = name(0).string() + " to " + name(film.frames() - 1).filename().string();
  return film.each_frame([&](std::uint32_t frame, std::span<const glm::vec3> positions) {
    return write_obj(film, frame, positions, name(frame), written);
  });
}

/// The mesh that a point cache moves, with the places of its first frame.
Status write_first_obj(const Film& film, const fs::path& path, Written& written) {
  return film.each_frame([&](std::uint32_t frame, std::span<const glm::vec3> positions) {
    return frame == 0 ? write_obj(film, frame, positions, path, written) : ok();
  });
}

}  // namespace

Status write_pc2(const Film& film, const Put& put) {
  if (Status head = put(model::point_cache_header(film.vertex_count(), film.frames())); !head) return head;
  return film.each_frame([&](std::uint32_t, std::span<const glm::vec3> positions) {
    return put({reinterpret_cast<const char*>(positions.data()), positions.size_bytes()});
  });
}

std::span<const Format> formats() {
  return all;
}

const Format* format_of(const std::string& ending) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Format& format) { return format.ending == ending; });
  return found == all.end() ? nullptr : &*found;
}

bool is_film(const std::string& ending) {
  return ending == ".obj" || format_of(ending) != nullptr;
}

Status check_size(const std::string& ending, std::uint64_t frames, std::uint64_t vertices) {
  const Format* format = format_of(ending);
  const std::string fewer =
      "fewer a second (--rate), a shorter --time, or .usda or .pc2, which have no such limit";
  if (format && format->most_frames > 0 && frames > format->most_frames)
    return Error{
        ending, std::to_string(frames) + " frames",
        "at most " + std::to_string(format->most_frames) + ", each of which is a morph target: " + fewer};
  if (ending == ".glb" && format->bytes(frames, vertices) > most_glb_bytes)
    return Error{ending, "a file of " + std::to_string(format->bytes(frames, vertices)) + " bytes",
                 "less than 4 GiB, as glTF has it: " + fewer};
  return ok();
}

std::string mesh_beside(const std::string& path) {
  return fs::path(path).replace_extension(".obj").string();
}

Result<Written> write_files(const Film& film, const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  Written written{path};
  Status done = check_size(ending, film.frames(), film.vertex_count());
  if (!done) return done.error();
  if (ending == ".obj") {
    done = write_obj_series(film, path, written);
  } else if (const Format* format = format_of(ending)) {
    done = into_file(path, written, [&](const Put& put) { return format->write(film, put); });
    if (done && ending == ".pc2") {
      written.names += " and " + mesh_beside(path);
      done = write_first_obj(film, mesh_beside(path), written);
    }
  } else {
    return Error{path, "no film can be written as " + ending, ".glb, .usda, .pc2 or .obj"};
  }
  if (!done) return done.error();
  return written;
}

}  // namespace clothlab::film
