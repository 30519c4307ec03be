#include "server/film/film.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "server/base/text.h"
#include "server/model/looks.h"

namespace clothlab::film {

namespace {

using nlohmann::json;

constexpr const char* plain_colour = "#b03a2e";
/// Half of the edge of a square that shows a plane, over the cloths' largest extent.
constexpr double planes_reach = 5.0;

bool same_mesh(const RecordedMesh& a, const RecordedMesh& b) {
  return &a == &b || (a.topology.triangles == b.topology.triangles && a.topology.cloths == b.topology.cloths);
}

bool is_colour(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

}  // namespace

Result<Film> Film::of(std::string_view recording, const Choice& choice) {
  Result<Reader> reader = Reader::open(recording);
  if (!reader) return reader.error();
  if (reader->frames() == 0)
    return Error{"the recording", "it has no frames", "record longer, of a session that plays"};
  Film film;
  film.title = reader->title();
  film.rate = reader->rate();
  film.groups_ = reader->groups();
  film.end_ = reader->frames();
  if (choice.rate)
    film.every_ = static_cast<std::uint32_t>(std::max(1.0, std::round(film.rate / *choice.rate)));
  film.rate /= film.every_;
  if (Status taken = film.take_looks(); !taken) return taken.error();
  if (Status taken = film.take_motion(choice.time); !taken) return taken.error();
  return film;
}

Status Film::take_looks() {
  const RecordedMesh& mesh = *groups_.front().mesh;
  const json& document = *groups_.front().document;
  triangles = mesh.topology.triangles;
  for (const auto& [u, v] : mesh.topology.texture_coordinates) texture_coordinates.emplace_back(u, v);
  const json looks = document.is_object() ? document.value("cloths", json()) : json();
  for (const auto& [first, count] : mesh.topology.cloths) {
    const json& look = looks.is_array() && cloths.size() < looks.size() ? looks[cloths.size()] : json();
    const std::string colour = text_at(look, "color", plain_colour);
    cloths.push_back({text_at(look, "name", "cloth-" + std::to_string(cloths.size() + 1)),
                      model::linear_colour(is_colour(colour) ? colour : plain_colour), first, count});
  }
  for (const auto& corners : triangles)
    for (Cloth& cloth : cloths) {
      const std::uint32_t first = cloth.first_vertex;
      if (corners[0] - first >= cloth.vertex_count) continue;  // also if it is less: numbers wrap
      if (corners[1] - first >= cloth.vertex_count || corners[2] - first >= cloth.vertex_count)
        return damaged(groups_.front().chunk.at, "a triangle between two cloths");
      cloth.triangles.push_back({corners[0] - first, corners[1] - first, corners[2] - first});
    }
  const Result<std::vector<Moment>> moments = moments_of(groups_.front(), true);
  if (!moments) return moments.error();
  const std::vector<glm::vec3>& places = moments->front().positions;
  if (places.empty()) return damaged(groups_.front().chunk.at, "a mesh without vertices");
  low = high = places.front();
  for (const glm::vec3& place : places) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  return ok();
}

Status Film::take_motion(std::optional<double> time) {
  const glm::dvec3 size(high - low);
  BodyTracks tracks(0.5 * glm::dvec3(low + high), planes_reach * std::max({size.x, size.y, size.z, 1e-3}));
  std::vector<scene::Collider> colliders;
  const json* document = nullptr;  // that `colliders` are of, if none moved
  std::optional<std::uint32_t> beyond;
  Clock clock(rate);
  const Status gone = each_moment(false, [&](std::uint32_t frame, const Group& group, Moment& moment) {
    if (beyond) return ok();
    const double shown = clock.next(moment.time);
    if (time && shown > *time + Clock::rounding) {
      beyond = frame * every_;
      return ok();
    }
    if (frame == 0) from = moment.time;
    to = moment.time;
    times.push_back(shown);
    if (!same_mesh(*group.mesh, *groups_.front().mesh))
      return Status(Error{"the recording",
                          "the cloths' mesh changes " + with_significant_digits(times.back(), 6) +
                              " s after its first frame, and this kind of file has one mesh",
                          "take what is before that, with a shorter --time, or a page (.html)"});
    if (document != group.document.get() || !moment.moving.empty()) {
      Result<std::vector<scene::Collider>> now = colliders_of(group, moment.moving);
      if (!now) return Status(now.error());
      colliders = std::move(*now);
      document = moment.moving.empty() ? group.document.get() : nullptr;
    }
    tracks.add(colliders);
    return ok();
  });
  if (!gone) return gone;
  if (beyond) end_ = *beyond;
  bodies = tracks.take();
  return ok();
}

Status Film::each_moment(bool with_positions,
                         const std::function<Status(std::uint32_t, const Group&, Moment&)>& take) const {
  for (const Group& group : groups_) {
    if (group.first >= end_) break;
    Result<std::vector<Moment>> moments = moments_of(group, with_positions);
    if (!moments) return moments.error();
    for (std::uint32_t i = 0; i < group.count && group.first + i < end_; ++i)
      if ((group.first + i) % every_ == 0)
        if (Status taken = take((group.first + i) / every_, group, (*moments)[i]); !taken) return taken;
  }
  return ok();
}

Status Film::each_frame(const Take& take) const {
  return each_moment(
      true, [&](std::uint32_t frame, const Group&, Moment& moment) { return take(frame, moment.positions); });
}

}  // namespace clothlab::film
