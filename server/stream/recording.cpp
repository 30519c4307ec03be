#include "server/stream/recording.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <numeric>
#include <utility>

#include "server/base/deflate.h"
#include "server/model/rest_lengths.h"
#include "server/scene/vertex_numbers.h"
#include "server/stream/folded.h"
#include "server/stream/frame.h"
#include "server/stream/recording_chunk.h"

namespace clothlab::stream {

namespace {

using nlohmann::json;

constexpr std::size_t axes = 3;

/// Positions are rounded to this share of a mean edge: a slope changes by half of it at most, which no
/// picture shows.
constexpr double share_of_edge = 1.0 / 512.0;
constexpr float largest_number = 65535.0f;
/// A group has at most so many vertices in all its frames.
constexpr std::size_t most_vertices = std::size_t{1} << 21;
constexpr std::uint8_t from_frame_before = 0x80;

template <class T>
void put_number(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string deflated(std::string_view bytes) {
  const std::vector<std::uint8_t> made =
      deflate_raw({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  return {made.begin(), made.end()};
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// The bits that numbers of this size take; their sum is near what deflate makes of them.
std::size_t cost(std::span<const std::uint16_t> numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), std::size_t{0},
                         [](std::size_t sum, std::uint16_t each) {
                           return sum + static_cast<std::size_t>(std::bit_width(each));
                         });
}

/// The differences of a frame's numbers [vertex, axis] from what is predicted of their change since `before`,
/// or, if that is empty, of themselves.
std::vector<std::uint16_t> differences(const Predictor& predictor, std::span<const std::uint16_t> numbers,
                                       std::span<const std::uint16_t> before) {
  std::vector<std::int32_t> changes(numbers.begin(), numbers.end());
  for (std::size_t i = 0; i < before.size(); ++i) changes[i] -= before[i];
  std::vector<std::uint16_t> folds(numbers.size());
  for (std::uint32_t i = 0; i < predictor.vertex_count(); ++i)
    for (std::size_t axis = 0; axis < axes; ++axis)
      folds[axes * i + axis] = folded(changes[axes * i + axis], predictor.at(i, changes.data(), axes, axis));
  return folds;
}

/// A body's triangles, before its transform.
std::string body_of(std::uint32_t collider, const scene::TriangleMesh& mesh) {
  std::string out;
  put_number(out, collider);
  put_number(out, static_cast<std::uint32_t>(mesh.vertices.size()));
  put_number(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::dvec3& vertex : mesh.vertices) put_number(out, glm::vec3(vertex));
  for (const auto& triangle : mesh.triangles) put_number(out, triangle);
  return out;
}

/// The numbers in frames of the vertices that the document counts of a cloth.
std::string numbers_of(std::uint32_t cloth, const scene::Mesh& mesh, std::uint32_t first_vertex) {
  std::string out;
  put_number(out, cloth);
  for (const std::uint32_t number :
       scene::numbers_in_frames(mesh, first_vertex, 0, scene::counted_vertices(mesh)))
    put_number(out, number);
  return out;
}

}  // namespace

Recording::Recording(std::function<void(std::string_view)> put, const json& scene, double rate)
    : put_(std::move(put)), most_in_group_(static_cast<std::size_t>(std::clamp(rate, 1.0, 120.0))) {
  std::string head = "CLOTHLAB";
  put_number(head, std::uint32_t{1});
  put_number(head, std::uint32_t{0});
  put_(head);
  bytes_ = head.size();
  chunk("head", "",
        deflated(text_of({{"program", "clothlab " CLOTHLAB_VERSION}, {"scene", scene}, {"rate", rate}})));
}

void Recording::chunk(const char (&kind)[5], std::string_view head, std::string_view content) {
  std::string start = chunk_start(std::string_view(kind, 4), head, content);
  put_(start.append(head));
  put_(content);
  bytes_ += start.size() + content.size();
}

void Recording::set_mesh(const model::Model& model, const scene::Scene& scene) {
  write_group();
  const SharedMessage topology = encode_topology(model, ++revision_);
  chunk("mesh", "", deflated({reinterpret_cast<const char*>(topology->data()), topology->size()}));
  const std::vector<float> lengths = model::edge_rest_lengths(model, scene);
  chunk("rest", "",
        deflated({reinterpret_cast<const char*>(lengths.data()), lengths.size() * sizeof(float)}));
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    if (const auto* body = std::get_if<scene::Body>(&scene.colliders[i].shape))
      chunk("body", "", deflated(body_of(static_cast<std::uint32_t>(i), *body->mesh)));
  for (std::uint32_t cloth = 0; cloth < scene.cloths.size(); ++cloth)
    if (const scene::Mesh& mesh = scene.cloths[cloth].mesh; scene::renumbered(mesh))
      chunk("nums", "", deflated(numbers_of(cloth, mesh, model.cloths[cloth].first_vertex)));
  predictor_ = Predictor(model.vertex_count(), model.triangles);
  const double sum = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  finest_ =
      lengths.empty() ? 0.0f : static_cast<float>(share_of_edge * sum / static_cast<double>(lengths.size()));
  group_size_ =
      std::clamp<std::size_t>(most_vertices / std::max(1u, model.vertex_count()), 1, most_in_group_);
}

void Recording::add(const RecordedFrame& frame) {
  times_.push_back(frame.time);
  steps_.push_back(frame.step);
  flags_.push_back(static_cast<std::uint8_t>(frame.flags));
  positions_.insert(positions_.end(), frame.positions.begin(), frame.positions.end());
  moving_.push_back(frame.moving.is_null() ? json::array() : frame.moving);
  ++frames_;
  if (times_.size() >= group_size_) write_group();
}

void Recording::change(const json& change) {
  write_group();
  chunk("edit", "", deflated(text_of(change)));
}

void Recording::finish(json ending) {
  write_group();
  ending["frames"] = frames_;
  chunk("done", "", deflated(text_of(ending)));
}

void Recording::write_group() {
  const std::size_t frames = times_.size(), count = predictor_.vertex_count();
  if (frames == 0) return;
  glm::vec3 low(0.0f), high(0.0f);
  bool first = true;
  for (glm::vec3& place : positions_) {
    // Of a blow-up nothing is recorded; whatever comes, a number is written.
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(place[axis])) place[axis] = 0.0f;
    low = first ? place : glm::min(low, place);
    high = first ? place : glm::max(high, place);
    first = false;
  }
  const glm::vec3 extent = high - low;
  const float largest = std::max({extent.x, extent.y, extent.z});
  float quantum = std::max(finest_, largest / largest_number);
  if (!(quantum > 0.0f)) quantum = 1.0f;

  std::vector<std::uint16_t> numbers(axes * count * frames), folds;
  for (std::size_t i = 0; i < positions_.size(); ++i)
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const auto at = static_cast<int>(axis);
      numbers[axes * i + axis] = static_cast<std::uint16_t>(
          std::min(std::round((positions_[i][at] - low[at]) / quantum), largest_number));
    }
  std::vector<char> planes(2 * axes * count * frames);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto of = [&](std::size_t k) {
      return std::span<const std::uint16_t>(numbers).subspan(axes * count * k, axes * count);
    };
    folds = differences(predictor_, of(frame), {});
    if (frame > 0) {
      std::vector<std::uint16_t> over_time = differences(predictor_, of(frame), of(frame - 1));
      if (cost(over_time) < cost(folds)) {
        folds = std::move(over_time);
        flags_[frame] |= from_frame_before;
      }
    }
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t axis = 0; axis < axes; ++axis) {
        const std::uint16_t fold = folds[axes * i + axis];
        planes[(axis * frames + frame) * count + i] = static_cast<char>(fold & 255);
        planes[((axes + axis) * frames + frame) * count + i] = static_cast<char>(fold >> 8);
      }
  }

  std::string head;
  put_number(head, static_cast<std::uint32_t>(frames));
  put_number(head, low);
  put_number(head, quantum);
  std::string content(reinterpret_cast<const char*>(times_.data()), frames * sizeof(double));
  content.append(reinterpret_cast<const char*>(steps_.data()), frames * sizeof(std::uint64_t));
  content.append(reinterpret_cast<const char*>(flags_.data()), frames);
  content.append(planes.data(), planes.size());
  if (std::any_of(moving_.begin(), moving_.end(), [](const json& each) { return !each.empty(); }))
    content += text_of(moving_);
  chunk("fram", head, deflated(content));
  times_.clear();
  steps_.clear();
  flags_.clear();
  positions_.clear();
  moving_ = json::array();
}

}  // namespace clothlab::stream
