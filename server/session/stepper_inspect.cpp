// inspect.*, as a session's thread answers them: numbers as little-endian arrays in base64.
#include <algorithm>
#include <utility>

#include "server/base/base64.h"
#include "server/model/spring_kinds.h"
#include "server/scene/vertex_numbers.h"
#include "server/session/stepper.h"
#include "server/sim/near_pairs.h"

namespace clothlab::session {

namespace {

/// The elements [first, end) of a list, of which an answer has a part.
struct Part {
  std::size_t first, end;

  Part(std::size_t from, std::size_t total)
      : first(std::min(from, total)), end(std::min(first + max_inspected_elements, total)) {}
  std::size_t count() const { return end - first; }
};

template <class Number>
void append(std::vector<Number>& to, const auto& from) {
  for (const auto value : from) to.push_back(static_cast<Number>(value));
}

}  // namespace

void Stepper::perform(InspectSprings& asked, const Ticket& ticket) {
  const model::Model& model = simulation().model();
  const Part part(asked.first, model.springs().size());
  const std::vector<model::SpringKind> all = model::spring_kinds(model, scene());
  std::vector<std::uint32_t> vertices;
  std::vector<float> rest_length;
  std::vector<std::uint8_t> kind;
  for (std::size_t i = part.first; i < part.end; ++i) {
    const model::Spring& spring = model.springs()[i];
    append(vertices, spring.vertices);
    rest_length.push_back(static_cast<float>(spring.law.rest_length));
    kind.push_back(static_cast<std::uint8_t>(all[i]));
  }
  reply(ticket, json{{"topology_revision", simulation().topology_revision()},
                     {"total", model.springs().size()},
                     {"first", part.first},
                     {"count", part.count()},
                     {"vertices", to_base64(vertices)},
                     {"rest_length", to_base64(rest_length)},
                     {"kind", to_base64(kind)}});
}

void Stepper::perform(InspectElements& asked, const Ticket& ticket) {
  const model::Model& model = simulation().model();
  const auto& elements = model.elements.of<elements::Membrane>();
  const Part part(asked.first, elements.size());
  std::vector<std::uint32_t> vertices;
  std::vector<float> shares;
  for (std::size_t i = part.first; i < part.end; ++i) {
    const elements::Membrane& law = elements[i].law;
    append(vertices, elements[i].vertices);
    append(shares, std::array{law.first_warp, law.first_weft, law.second_warp, law.second_weft});
  }
  reply(ticket, json{{"topology_revision", simulation().topology_revision()},
                     {"total", elements.size()},
                     {"first", part.first},
                     {"count", part.count()},
                     {"vertices", to_base64(vertices)},
                     {"shares", to_base64(shares)}});
}

void Stepper::perform(InspectVertices& asked, const Ticket& ticket) {
  const model::Model& model = simulation().model();
  if (asked.cloth >= model.cloths.size())
    return reply(ticket, no_such("/cloth", asked.cloth, "a cloth of the scene: cloth", model.cloths.size()));
  const scene::Mesh& mesh = scene().cloths[asked.cloth].mesh;
  const Part part(asked.first, scene::counted_vertices(mesh));
  const std::vector<std::uint32_t> vertices =
      scene::numbers_in_frames(mesh, model.cloths[asked.cloth].first_vertex, part.first, part.end);
  reply(ticket, json{{"topology_revision", simulation().topology_revision()},
                     {"cloth", asked.cloth},
                     {"total", scene::counted_vertices(mesh)},
                     {"first", part.first},
                     {"count", part.count()},
                     {"vertices", to_base64(vertices)}});
}

/// The nearest ones of what was read last, `most` at most.
json Stepper::contacts_told(std::size_t most) const {
  const std::size_t count = std::min(most, contacts_.near.pairs.size());
  std::vector<std::uint8_t> kind;
  std::vector<std::uint32_t> vertices;
  std::vector<float> shares, gap, keep, nearest;
  for (std::size_t i = 0; i < count; ++i) {
    const sim::NearPair& pair = contacts_.near.pairs[i];
    kind.push_back(static_cast<std::uint8_t>(pair.kind));
    append(vertices, pair.vertices);
    append(shares, pair.shares);
    gap.push_back(static_cast<float>(pair.gap));
    keep.push_back(static_cast<float>(pair.keep));
    for (const glm::dvec3& point : pair.nearest) append(nearest, std::array{point.x, point.y, point.z});
  }
  return {{"topology_revision", contacts_.topology_revision},
          {"revision", contacts_.revision},
          {"time", contacts_.time},
          {"step", contacts_.step},
          {"searched", contacts_.near.searched},
          {"total", contacts_.total},
          {"count", count},
          {"kind", to_base64(kind)},
          {"vertices", to_base64(vertices)},
          {"shares", to_base64(shares)},
          {"gap", to_base64(gap)},
          {"keep", to_base64(keep)},
          {"nearest", to_base64(nearest)}};
}

// The pairs are read from the GPU, which takes time from the steps: who asks often gets what was read before,
// however many he asks for.
void Stepper::perform(InspectContacts& asked, const Ticket& ticket) {
  const Clock::time_point now = Clock::now();
  const bool same = contacts_.read && contacts_.revision == revision_ &&
                    contacts_.topology_revision == simulation().topology_revision();
  const bool unmoved = contacts_.state_version == state_version_;
  const bool fresh = run_.plays() && now - contacts_.at < period(inspection_rate);
  if (!same || (!unmoved && !fresh)) {
    contacts_ = {true,
                 simulation().near_pairs(),
                 0,
                 simulation().topology_revision(),
                 revision_,
                 state_version_,
                 simulation().time(),
                 simulation().step_index(),
                 now};
    contacts_.total = contacts_.near.pairs.size();
    contacts_.near.pairs.resize(std::min(contacts_.total, max_inspected_contacts));
  }
  if (!contacts_.text || contacts_.most != asked.most) {
    contacts_.text = text_of(contacts_told(asked.most));
    contacts_.most = asked.most;
  }
  reply(ticket, contacts_.text);
}

}  // namespace clothlab::session
