#include "server/session/recorder.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "server/base/priority.h"

namespace clothlab::session {

namespace {
constexpr std::size_t most_waiting = 16;
}

Recorder::~Recorder() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

void Recorder::start(double rate, const json& document, const std::string& name) {
  RecordingFacts facts;
  facts.state = RecordingFacts::State::recording;
  facts.rate = rate;
  facts.scene = name;
  exchange_.store_recording(facts);
  tasks_.clear();
  done_ = false;
  revision_ = 0;
  recording_ = true;
  thread_ = std::thread([this, rate, document, facts] { run(rate, document, facts); });
}

void Recorder::mesh(std::shared_ptr<const model::Model> model, std::shared_ptr<const scene::Scene> scene,
                    std::uint32_t revision) {
  add(Mesh{std::move(model), std::move(scene), revision});
}

void Recorder::frame(stream::SharedMessage frame) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= most_waiting) return;
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
    stream::Recording writer([&](std::string_view more) { bytes += more; }, document, rate);
    end_ = record(writer, bytes, facts);
    facts.state = RecordingFacts::State::ready;
    facts.full = end_ == End::limit;
    facts.frames = writer.frames();
    facts.bytes = bytes.size();
    facts.file = std::make_shared<const std::string>(std::move(bytes));
  } catch (const std::bad_alloc&) {
    end_ = End::failed;
    facts = {};
  }
  exchange_.store_recording(facts);
  done_ = true;
}

Recorder::End Recorder::record(stream::Recording& writer, std::string& bytes, RecordingFacts& facts) {
  const auto finish = [&](End end) {
    writer.finish({{"time", time_}, {"diverged", nullptr}});
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
    facts.bytes = bytes.size();
    if (bytes.size() > most_) return finish(End::limit);
    exchange_.store_recording(facts);
  }
}

void Recorder::perform(Task& task, stream::Recording& writer) {
  if (const auto* mesh = std::get_if<Mesh>(&task)) {
    writer.set_mesh(*mesh->model, *mesh->scene);
    revision_ = mesh->revision;
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
  time_ = header.time;
}

}  // namespace clothlab::session
