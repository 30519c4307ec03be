#include "server/film/reader.h"

#include <cmath>
#include <utility>

#include "server/scene/document.h"
#include "server/stream/folded.h"

namespace clothlab::film {

namespace {

using nlohmann::json;

constexpr std::size_t axes = 3;
constexpr std::uint8_t from_frame_before = 0x80;
constexpr std::uint32_t longest_group = 120;  ///< frames

Result<json> parsed(const Chunk& chunk, std::string_view text) {
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) return damaged(chunk.at, "the chunk " + std::string(chunk.kind) + " is no JSON");
  return value;
}

/// The numbers of a frame from its planes, which hold how far they are from what is predicted.
struct Planes {
  std::string_view bytes;  ///< six for each frame: the low bytes of x, y and z, then the high ones
  std::size_t frames = 0, count = 0;
  std::uint16_t fold(std::size_t frame, std::size_t axis, std::size_t vertex) const {
    const auto byte = [&](std::size_t plane) {
      return static_cast<std::uint8_t>(bytes[(plane * frames + frame) * count + vertex]);
    };
    return static_cast<std::uint16_t>(byte(axis) | byte(axes + axis) << 8);
  }
};

/// `numbers` [vertex, axis] are those of the frame before if `over_time`, and become those of this one.
void unfold(const Planes& planes, std::size_t frame, const stream::Predictor& predictor, bool over_time,
            std::vector<std::uint16_t>& numbers) {
  std::vector<std::int32_t> changes(numbers.size());
  for (std::uint32_t i = 0; i < planes.count; ++i)
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const std::size_t at = axes * i + axis;
      const int before = over_time ? numbers[at] : 0;
      const std::int32_t predicted = predictor.at(i, changes.data(), axes, axis);
      numbers[at] =
          static_cast<std::uint16_t>(before + predicted + stream::unfolded(planes.fold(frame, axis, i)));
      changes[at] = numbers[at] - before;
    }
}

}  // namespace

std::string text_at(const json& object, const char* key, const std::string& otherwise) {
  const json value = object.is_object() ? object.value(key, json()) : json();
  return value.is_string() ? value.get<std::string>() : otherwise;
}

Result<Reader> Reader::open(std::string_view file) {
  const Result<std::vector<Chunk>> chunks = chunks_of(file);
  if (!chunks) return chunks.error();
  Reader reader;
  for (const Chunk& chunk : *chunks) {
    if (reader.done_) return damaged(chunk.at, "more comes after its end");
    if ((chunk.kind == "head") != (reader.document_ == nullptr))
      return damaged(chunk.at, "its head is not the first chunk");
    if (const Status taken = reader.take(chunk); !taken) return taken.error();
  }
  if (!reader.done_) return damaged(file.size(), "it has no end: it is cut off, or still being made");
  return reader;
}

Status Reader::take(const Chunk& chunk) {
  if (chunk.kind == "fram") return take_group(chunk);
  if (chunk.kind != "head" && chunk.kind != "mesh" && chunk.kind != "body" && chunk.kind != "edit" &&
      chunk.kind != "done")
    return ok();
  const Result<std::string> content = inflated(chunk, chunk.content);
  if (!content) return content.error();
  if (chunk.kind == "mesh") return take_mesh(chunk, *content);
  if (chunk.kind == "body") return take_body(chunk, *content);
  Result<json> value = parsed(chunk, *content);
  if (!value) return value.error();
  if (!value->is_object()) return damaged(chunk.at, "the chunk " + std::string(chunk.kind) + " is no object");
  if (chunk.kind == "edit") return take_edit(chunk, *value);
  if (chunk.kind == "done") {
    if (value->value("frames", json()) != json(frames_))
      return damaged(chunk.at,
                     "it says that it has another number of frames than " + std::to_string(frames_));
    diverged_ = value->value("diverged", json());
    done_ = true;
    return ok();
  }
  const json rate = value->value("rate", json());
  if (!rate.is_number() || !(rate > 0.0 && rate < 1e4)) return damaged(chunk.at, "its rate is none");
  rate_ = rate;
  document_ = std::make_shared<const json>(value->value("scene", json()));
  title_ = text_at(*document_, "name", "cloth");
  return ok();
}

Status Reader::take_edit(const Chunk& chunk, const json& edit) {
  if (edit.contains("document")) {
    document_ = std::make_shared<const json>(edit["document"]);
  } else if (edit.contains("patch")) {
    Result<json> changed = scene::patched(*document_, edit["patch"]);
    if (!changed) return damaged(chunk.at, "a change of its scene cannot be carried out");
    document_ = std::make_shared<const json>(std::move(*changed));
  }
  return ok();
}

Status Reader::take_mesh(const Chunk& chunk, const std::string& content) {
  Result<decode::Decoded> read =
      decode::decode_frame({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
  if (!read) return damaged(chunk.at, "its mesh has at " + read.error().where + " " + read.error().what);
  auto* topology = std::get_if<decode::Topology>(&read->payload);
  if (!topology) return damaged(chunk.at, "a frame in place of a mesh");
  mesh_ = std::make_shared<RecordedMesh>();
  mesh_->predictor = stream::Predictor(read->header.vertex_count, topology->triangles);
  mesh_->topology = std::move(*topology);
  return ok();
}

Status Reader::take_body(const Chunk& chunk, const std::string& content) {
  if (!mesh_) return damaged(chunk.at, "a body comes before a mesh");
  Numbers numbers(content);
  const auto collider = numbers.next<std::uint32_t>();
  const std::size_t vertices = numbers.next<std::uint32_t>(), triangles = numbers.next<std::uint32_t>();
  if (!numbers.complete() || numbers.left() != 4 * axes * (vertices + triangles))
    return damaged(chunk.at, "a body of another size than it says");
  scene::TriangleMesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    glm::vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = numbers.next<float>();
      if (!std::isfinite(place[axis])) return damaged(chunk.at, "a body with a place that is no number");
    }
    mesh.vertices.emplace_back(place);
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    auto& triangle = mesh.triangles.emplace_back();
    for (std::uint32_t& corner : triangle) {
      corner = numbers.next<std::uint32_t>();
      if (corner >= vertices) return damaged(chunk.at, "a body with a corner that it has not");
    }
  }
  // Groups before this chunk keep the mesh that they had.
  mesh_ = std::make_shared<RecordedMesh>(*mesh_);
  mesh_->bodies[collider] = std::make_shared<const scene::TriangleMesh>(std::move(mesh));
  return ok();
}

Status Reader::take_group(const Chunk& chunk) {
  if (!mesh_) return damaged(chunk.at, "frames come before a mesh");
  Numbers head(chunk.content.substr(0, std::min(chunk.content.size(), group_head_bytes)));
  const auto count = head.next<std::uint32_t>();
  bool places = true;
  float last = 0;
  for (int i = 0; i < 4; ++i) places = std::isfinite(last = head.next<float>()) && places;
  if (!head.complete() || count == 0 || count > longest_group)
    return damaged(chunk.at, "a group of " + std::to_string(count) + " frames, of 1 to 120");
  if (!places || !(last > 0.0f)) return damaged(chunk.at, "frames without places");
  groups_.push_back({frames_, count, mesh_, document_, chunk});
  frames_ += count;
  return ok();
}

Result<std::vector<Moment>> moments_of(const Group& group, bool with_positions) {
  Numbers head(group.chunk.content.substr(sizeof(std::uint32_t)));
  glm::vec3 low;
  for (int axis = 0; axis < 3; ++axis) low[axis] = head.next<float>();
  const auto quantum = head.next<float>();
  const Result<std::string> content = inflated(group.chunk, group.chunk.content.substr(group_head_bytes));
  if (!content) return content.error();
  const std::size_t count = group.mesh->predictor.vertex_count(), frames = group.count;
  const std::size_t planes_at = 17 * frames, planes_bytes = 2 * axes * frames * count;
  if (content->size() < planes_at + planes_bytes) return damaged(group.chunk.at, "frames that are not whole");
  const std::string_view all = *content;
  const Planes planes{all.substr(planes_at, planes_bytes), frames, count};
  json moving = json::array();
  if (const std::string_view text = all.substr(planes_at + planes_bytes); !text.empty()) {
    Result<json> read = parsed(group.chunk, text);
    if (!read) return read.error();
    if (!read->is_array()) return damaged(group.chunk.at, "colliders that move, not as a list");
    moving = std::move(*read);
  }
  Numbers times(all), steps(all.substr(8 * frames));
  std::vector<Moment> moments(frames);
  std::vector<std::uint16_t> numbers(with_positions ? axes * count : 0);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    Moment& moment = moments[frame];
    moment.time = times.next<double>();
    moment.step = steps.next<std::uint64_t>();
    if (!(moment.time >= 0.0 && moment.time < 1e9)) return damaged(group.chunk.at, "a time that is none");
    moment.moving = frame < moving.size() ? std::move(moving[frame]) : json::array();
    if (!with_positions) continue;
    const bool over_time = (static_cast<std::uint8_t>(all[16 * frames + frame]) & from_frame_before) != 0;
    unfold(planes, frame, group.mesh->predictor, over_time && frame > 0, numbers);
    moment.positions.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
      moment.positions.push_back(
          low + quantum * glm::vec3(numbers[axes * i], numbers[axes * i + 1], numbers[axes * i + 2]));
  }
  return moments;
}

double Clock::next(double simulated) {
  const double passed = simulated - before_;
  before_ = simulated;
  return shown_ = shown_ < 0.0 ? 0.0 : shown_ + (passed > 0.0 ? passed : 1.0 / rate_);
}

}  // namespace clothlab::film
