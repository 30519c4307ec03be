#include "server/stream/packer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/stream/field_pass.h"
#include "shaders/slots.h"

namespace clothlab::stream {

namespace {

constexpr int group_size = 128;
constexpr int ring_slots = 3;  ///< most frames on their way back at once
constexpr std::size_t box_bytes = 32;

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

struct Packer::Implementation {
  gl::Program bounds;
  std::array<gl::Program, encoding_count> pack, pack_with_field;
  FieldPass field;
  gl::TextureBuffer fan_offsets, fans;
  std::array<gl::Buffer, encoding_count> packed;
  gl::Buffer box;
  gl::ReadbackRing ring;
  std::array<std::int64_t, ring_slots> requested_at_us{};
  std::array<Header, ring_slots> headers;  ///< of the frames in the ring, at (sequence - 1) % ring_slots
  std::array<std::vector<std::uint8_t>, ring_slots> colliders;
  std::uint32_t requested = 0, delivered = 0;
  std::uint32_t topology_revision = 0, vertex_count = 0;

  /// Makes the buffers that depend on the mesh; frames of the old mesh that are on their way are dropped.
  void set_mesh(const model::Model& model, std::uint32_t revision) {
    topology_revision = revision;
    vertex_count = model.vertex_count();
    fan_offsets = {gl::Buffer(model.vertex_triangles.offsets), GL_R32UI};
    fans = {gl::Buffer(model::vertex_fans(model)), GL_RG32UI};
    std::size_t most = 0;
    for (std::size_t i = 0; i < encoding_count; ++i) {
      // With room for a field, which is written four bytes at a time.
      const std::size_t bytes =
          box_bytes + vertex_count * encodings[i].bytes_per_vertex + (vertex_count + 3) / 4 * 4;
      packed[i] = gl::Buffer(bytes);
      most = std::max(most, bytes);
    }
    ring = gl::ReadbackRing(most, ring_slots);
    field.set_mesh(vertex_count);
    delivered = requested;
  }

  void dispatch(const gl::Program& program) const {
    program.use();
    program.set("vertex_count", static_cast<GLint>(vertex_count));
    glDispatchCompute((vertex_count + group_size - 1) / group_size, 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  SharedMessage take(bool wait) {
    const std::span<const std::byte> bytes = ring.front(wait);
    if (bytes.empty()) return nullptr;
    auto message = std::make_shared<Message>();
    message->header = headers[delivered % ring_slots];
    message->made_at_us = requested_at_us[delivered % ring_slots];
    message->colliders = std::move(colliders[delivered % ring_slots]);
    Header& header = message->header;
    std::memcpy(&header.box_minimum, bytes.data(), sizeof(glm::vec3));
    std::memcpy(&header.box_extent, bytes.data() + 16, sizeof(glm::vec3));
    if (header.field != Field::none) std::memcpy(&header.range, bytes.data() + 12, sizeof header.range);
    message->bytes.resize(front_room + header_bytes + header.payload_bytes);
    write_header(header, message->bytes.data() + front_room);
    std::memcpy(message->bytes.data() + front_room + header_bytes, bytes.data() + box_bytes,
                header.payload_bytes);
    ring.pop();
    ++delivered;
    return message;
  }
};

Packer::Packer() : implementation_(std::make_unique<Implementation>()) {}
Packer::~Packer() = default;

Result<std::unique_ptr<Packer>> Packer::create(std::uint32_t last) {
  std::unique_ptr<Packer> packer(new Packer);
  Implementation& self = *packer->implementation_;
  self.requested = self.delivered = last;
  const std::string group = std::to_string(group_size);
  const auto load = [&group](gl::Program& into, const char* path, gl::Defines defines) -> Status {
    defines.emplace_back("GROUP_SIZE", group);
    Result<gl::Program> program = gl::Program::load({path}, defines);
    if (!program) return program.error();
    into = std::move(*program);
    return ok();
  };
  if (Status status = load(self.bounds, "stream/bounds.comp", {}); !status) return status.error();
  for (std::size_t i = 0; i < encoding_count; ++i) {
    if (encodings[i].packed_as != encodings[i].encoding) continue;
    gl::Defines defines{{encodings[i].define, "1"},
                        {"WORDS", std::to_string(encodings[i].bytes_per_vertex / 4)}};
    if (Status status = load(self.pack[i], "stream/pack.comp", defines); !status) return status.error();
    defines.emplace_back("WITH_FIELD", "1");
    if (Status status = load(self.pack_with_field[i], "stream/pack.comp", defines); !status)
      return status.error();
  }
  Result<FieldPass> field = FieldPass::create();
  if (!field) return field.error();
  self.field = std::move(*field);
  self.box = gl::Buffer(8 * sizeof(std::uint32_t));
  return packer;
}

bool Packer::request(const sim::Simulation& simulation, Form form, std::uint16_t flags,
                     std::string_view colliders) {
  const std::int64_t begun_us = now_us();
  Implementation& self = *implementation_;
  if (self.topology_revision != simulation.topology_revision() || self.vertex_count == 0)
    self.set_mesh(simulation.model(), simulation.topology_revision());
  if (self.ring.full()) return false;

  const auto index = static_cast<std::size_t>(facts(form.encoding).packed_as);
  const bool with_field = form.field != Field::none;
  const gl::Program& pack = (with_field ? self.pack_with_field : self.pack)[index];
  const std::array<std::uint32_t, 8> empty_box{~0u, ~0u, ~0u, ~0u, 0u, 0u, 0u, 0u};
  self.box.upload(empty_box.data(), sizeof(empty_box));
  if (with_field) self.field.compute(simulation, form.field, pack);
  simulation.bind_positions(unit_position);
  self.fan_offsets.bind(unit_fan_offsets);
  self.fans.bind(unit_fans);
  self.box.bind_storage(slot_bounds);
  self.packed[index].bind_storage(slot_packed);
  self.dispatch(self.bounds);
  self.dispatch(pack);

  self.requested_at_us[self.requested % ring_slots] = begun_us;
  std::vector<std::uint8_t>& text = self.colliders[self.requested % ring_slots];
  text.clear();
  if (!colliders.empty()) {
    text.resize(front_room);
    text.insert(text.end(), colliders.begin(), colliders.end());
  }
  Header& header = self.headers[self.requested % ring_slots];
  header.encoding = form.encoding;
  header.field = form.field;
  header.range = 0;
  header.flags = flags;
  header.topology_revision = self.topology_revision;
  header.sequence = ++self.requested;
  header.vertex_count = self.vertex_count;
  header.time = simulation.time();
  header.step = simulation.step_index();
  header.payload_bytes = static_cast<std::uint32_t>(self.vertex_count * form.bytes_per_vertex());
  self.ring.push(self.packed[index], box_bytes + header.payload_bytes);
  return true;
}

SharedMessage Packer::poll() {
  return implementation_->take(false);
}
SharedMessage Packer::wait() {
  return implementation_->take(true);
}

}  // namespace clothlab::stream
