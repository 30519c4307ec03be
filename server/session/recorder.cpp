#include "server/session/recorder.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "server/base/priority.h"

namespace clothlab::session {

namespace {

// Frames that wait: so many, and of a large mesh fewer.
constexpr std::size_t most_waiting = 16, most_waiting_bytes = 32 << 20;

/// What a recording takes besides its file: frames that wait, and the writer's group, as places, as numbers
/// and as they are compressed (stream/recording.cpp).
std::size_t bytes_under_way(std::uint32_t vertices, double rate) {
  constexpr std::size_t most_in_group = std::size_t{1} << 21, bytes_in_group = 40;
  const std::size_t frame = facts(stream::Encoding::f32).bytes_per_vertex * vertices;
  const std::size_t group =
      std::max<std::size_t>(vertices, std::min(most_in_group, vertices * static_cast<std::size_t>(rate)));
  return std::max(frame, std::min(most_waiting * frame, most_waiting_bytes)) + bytes_in_group * group;
}

}  // namespace

Recorder::~Recorder() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

clothlab::Status Recorder::start(double rate, const json& document, const std::string& name,
                                 std::uint32_t vertices) {
  under_way_ = bytes_under_way(vertices, rate);
  Result<MemoryBudget::Reservation> place =
      MemoryBudget::reserve(budget_, MemoryBudget::Use::recordings, under_way_);
  if (!place) return place.error();
  memory_ = std::move(*place);
  rate_ = rate;
  out_of_memory_ = false;
  RecordingFacts facts;
  facts.state = RecordingFacts::State::recording;
  facts.rate = rate;
  facts.scene = name;
  facts.vertices = vertices;
  exchange_.store_recording(facts);
  tasks_.clear();
  done_ = false;
  revision_ = 0;
  times_.reset();
  recording_ = true;
  thread_ = std::thread([this, rate, document, facts] { run(rate, document, facts); });
  return ok();
}

void Recorder::mesh(std::shared_ptr<const model::Model> model, std::shared_ptr<const scene::Scene> scene,
                    std::uint32_t revision) {
  add(Mesh{std::move(model), std::move(scene), revision});
}

void Recorder::frame(stream::SharedMessage frame) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= most_waiting) return;
    if (!tasks_.empty() && (tasks_.size() + 1) * frame->size() > most_waiting_bytes) return;
  }
  add(std::move(frame));
}

void Recorder::change(json change) {
  add(std::move(change));
}

void Recorder::stop() {
  recording_ = false;
  add(Stop{});
}

void Recorder::add(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  task_arrived_.notify_one();
}

std::optional<Recorder::End> Recorder::poll() {
  if (!busy() || !done_) return std::nullopt;
  thread_.join();
  recording_ = false;
  return end_;
}

void Recorder::run(double rate, const json& document, RecordingFacts facts) {
  lower_priority(5);
  std::string bytes;
  try {
    stream::Recording writer([&](std::string_view more) { append(bytes, more); }, document, rate);
    end_ = record(writer, bytes, facts);
    facts.state = RecordingFacts::State::ready;
    facts.full = end_ == End::limit || end_ == End::memory;
    facts.frames = writer.frames();
    facts.times = times_;
    facts.bytes = bytes.size();
    (void)memory_.resize(bytes.capacity());
    facts.file = held_text(std::move(bytes), std::move(memory_));
  } catch (const std::bad_alloc&) {
    end_ = End::failed;
    facts = {};
    memory_ = {};
  }
  exchange_.store_recording(facts);
  done_ = true;
}

/// The file grows by a quarter; meanwhile there are the old and the new copy. Where there is no memory for
/// that it takes what it must, to end whole: no more than what was under way.
void Recorder::append(std::string& bytes, std::string_view more) {
  constexpr std::size_t least = 1 << 20;
  const std::size_t needed = bytes.size() + more.size(), had = bytes.capacity();
  if (needed > had) {
    std::size_t next = std::max(needed, had + std::max(least, had / 4));
    if (!memory_.resize(under_way_ + had + next)) {
      out_of_memory_ = true;
      next = needed;
    }
    bytes.reserve(next);
    (void)memory_.resize(under_way_ + bytes.capacity());
  }
  bytes += more;
}

Recorder::End Recorder::record(stream::Recording& writer, std::string& bytes, RecordingFacts& facts) {
  const auto finish = [&](End end) {
    writer.finish({{"time", times_ ? times_->second : 0.0}, {"diverged", nullptr}});
    return end;
  };
  while (true) {
    Task task = Stop{};
    {
      std::unique_lock lock(mutex_);
      task_arrived_.wait(lock, [&] { return ending_ || !tasks_.empty(); });
      if (ending_) return End::asked;  // with the session: nobody asks for it
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    if (std::holds_alternative<Stop>(task)) return finish(End::asked);
    perform(task, writer);
    facts.frames = writer.frames();
    facts.times = times_;
    facts.bytes = bytes.size();
    if (bytes.size() > most_) return finish(End::limit);
    if (out_of_memory_) return finish(End::memory);
    exchange_.store_recording(facts);
  }
}

void Recorder::perform(Task& task, stream::Recording& writer) {
  if (const auto* mesh = std::get_if<Mesh>(&task)) {
    writer.set_mesh(*mesh->model, *mesh->scene);
    revision_ = mesh->revision;
    const std::size_t under_way = bytes_under_way(mesh->model->vertex_count(), rate_);
    if (memory_.resize(memory_.bytes() - std::min<std::uint64_t>(memory_.bytes(), under_way_) + under_way))
      under_way_ = under_way;
    else
      out_of_memory_ = true;
  } else if (const auto* frame = std::get_if<stream::SharedMessage>(&task)) {
    if ((*frame)->header.topology_revision == revision_) write(**frame, writer);
  } else if (const auto* change = std::get_if<json>(&task)) {
    writer.change(*change);
  }
}

void Recorder::write(const stream::Message& frame, stream::Recording& writer) {
  const stream::Header& header = frame.header;
  std::vector<glm::vec3> positions(header.vertex_count);
  const std::size_t stride = facts(stream::Encoding::f32).bytes_per_vertex;
  const std::uint8_t* at = frame.data() + stream::header_bytes;
  for (glm::vec3& position : positions) {
    std::memcpy(&position, at, sizeof position);
    at += stride;
  }
  json moving = nullptr;
  if (frame.colliders.size() > stream::front_room)
    moving =
        json::parse(frame.colliders.begin() + stream::front_room, frame.colliders.end())["params"]["moving"];
  writer.add({header.time, header.step, header.flags, positions, std::move(moving)});
  times_ = {times_ ? times_->first : header.time, header.time};
}

}  // namespace clothlab::session
