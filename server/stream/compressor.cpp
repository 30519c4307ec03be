#include "server/stream/compressor.h"

#include <cstring>
#include <new>
#include <span>
#include <utility>

#include "server/base/deflate.h"
#include "server/stream/c16.h"

namespace clothlab::stream {

namespace {

constexpr std::size_t most_waiting = 2;

struct Packed {  // as pack.comp writes q16; the normal is not sent
  Position position;
  std::uint16_t normal;
};
static_assert(sizeof(Packed) == facts(Encoding::q16).bytes_per_vertex);

/// The field's bytes, then the bits of the positions.
std::vector<std::uint8_t> content_of(const Message& packed, const Predictor& predictor) {
  const std::size_t count = predictor.vertex_count();
  const std::uint8_t* payload = packed.data() + header_bytes;
  std::vector<Position> positions(count);
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(&positions[i], payload + i * sizeof(Packed), sizeof(Position));
  const std::uint8_t* field = payload + count * sizeof(Packed);
  std::vector<std::uint8_t> content(field, field + (packed.header.field == Field::none ? 0 : count));
  const glm::vec3& extent = packed.header.box_extent;
  put_positions(content, positions, {extent.x, extent.y, extent.z}, predictor);
  return content;
}

}  // namespace

SharedMessage compress(const Message& packed, const Predictor& predictor) {
  auto message = std::make_shared<Message>();
  message->bytes = deflate_raw(content_of(packed, predictor), front_room + header_bytes);
  message->header = packed.header;
  message->header.payload_bytes =
      static_cast<std::uint32_t>(message->bytes.size() - front_room - header_bytes);
  message->colliders = packed.colliders;
  message->made_at_us = packed.made_at_us;
  write_header(message->header, message->bytes.data() + front_room);
  return message;
}

Compressor::~Compressor() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

void Compressor::set_mesh(const model::Model& model, std::uint32_t revision) {
  if (triangles_ && revision == revision_) return;
  triangles_ = std::make_shared<const Triangles>(model.triangles);
  revision_ = revision;
}

bool Compressor::full() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size() >= most_waiting;
}

void Compressor::offer(SharedMessage packed) {
  ++offered_;
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({std::move(packed), triangles_});
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  task_arrived_.notify_one();
}

SharedMessage Compressor::poll() {
  const std::lock_guard lock(mutex_);
  SharedMessage message;
  while (!message && !done_.empty()) {
    message = std::move(done_.front());
    done_.pop_front();
    ++given_;
  }
  return message;
}

void Compressor::run() {
  std::shared_ptr<const Triangles> known;
  Predictor predictor;
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      task_arrived_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
      if (ending_) return;
      task = std::move(waiting_.front());
      waiting_.pop_front();
    }
    SharedMessage made;
    try {
      if (task.triangles != known) {
        predictor = Predictor(task.packed->header.vertex_count, *task.triangles);
        known = task.triangles;
      }
      made = compress(*task.packed, predictor);
    } catch (const std::bad_alloc&) {  // this frame is not shown; the next may be
      known.reset();
    }
    const std::lock_guard lock(mutex_);
    done_.push_back(std::move(made));
  }
}

}  // namespace clothlab::stream
