#include "server/session/exporter.h"

#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "server/base/priority.h"
#include "server/film/formats.h"
#include "server/gl/context.h"
#include "server/model/glb.h"
#include "server/model/mesh_file.h"
#include "server/render/renderer.h"
#include "server/session/fault.h"
#include "server/stream/recording.h"

namespace clothlab::session {

namespace {

const char* type_of(const Export& what) {
  if (const film::Format* film = film::format_of(what.recording)) return film->content_type;
  if (!what.recording.empty()) return "text/html; charset=utf-8";
  switch (what.kind) {
    case Export::Kind::obj:
      return "text/plain; charset=utf-8";
    case Export::Kind::glb:
      return "model/gltf-binary";
    case Export::Kind::picture:
      return "image/png";
  }
  return "";
}

Result<std::string> film_of(std::string_view recording, const film::Format& format) {
  const Result<film::Film> film = film::Film::of(recording);
  if (!film) return film.error();
  std::string bytes;
  const clothlab::Status written = format.write(*film, [&](std::string_view more) {
    bytes += more;
    return ok();
  });
  if (!written) return written.error();
  return bytes;
}

/// A PNG. Each picture has a new context, as Mesa frees a picture's memory, up to 0.8 GB, only with its
/// context.
Result<std::string> picture(std::optional<int> gpu, const Moment& moment, const model::Model& model,
                            const Export& what) {
  // With the lab, which can wait: a picture on a display of small sessions would hold these up for seconds.
  gl::make_helper_threads(gpu, gl::HelperThreads::lab);
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(gpu, gl::HelperThreads::lab);
  if (!context) return context.error();
  const Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create();
  if (!renderer) return renderer.error();
  const Result<render::Image> image = (*renderer)->render(
      {moment.document->scene, model, moment.positions, moment.colliders}, what.width, what.height);
  if (!image) return image.error();
  if ((*context)->lost() || fault_due(Fault::context_lost, fault_in_exporter, 0))
    return Error{"OpenGL", "the device was reset while it drew", "ask again"};
  const Result<std::vector<std::uint8_t>> png = render::encode_png(*image);
  if (!png) return png.error();
  return std::string(png->begin(), png->end());
}

}  // namespace

void Exporter::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

void Exporter::begin(std::uint64_t asker, const Export& what, Moment moment) {
  busy_ = true;
  {
    const std::lock_guard lock(mutex_);
    task_ = Task{asker, what, std::move(moment)};
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  task_arrived_.notify_one();
}

std::optional<Exported> Exporter::take() {
  std::optional<Exported> made;
  {
    const std::lock_guard lock(mutex_);
    made = std::exchange(made_, std::nullopt);
  }
  if (made) busy_ = false;
  return made;
}

void Exporter::run() {
  // Lower priority than any session, but higher than the lab, as a user waits for the file. What software
  // OpenGL computes of a picture has the priority of its threads (gl/software/software.h).
  lower_priority(10);
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      task_arrived_.wait(lock, [&] { return ending_ || task_; });
      if (ending_) return;
      task = *std::exchange(task_, std::nullopt);
    }
    const char* type = type_of(task.what);
    Exported made{task.asker, type, carry_out(task), task.moment.recording, task.what.recording};
    {
      const std::lock_guard lock(mutex_);
      made_ = std::move(made);
    }
    wake_();
  }
}

Result<std::string> Exporter::carry_out(const Task& task) const {
  try {
    provoke_fault(fault_in_exporter, 0);
    return make_(task.moment, task.what);
  } catch (const std::bad_alloc&) {
    return Error{"export", "there was not enough memory", "ask again, for a smaller picture"};
  } catch (const std::exception& error) {
    return Error{"export", error.what(), "ask again; please report it if it happens twice"};
  }
}

Result<std::string> make_export(std::optional<int> gpu, const Moment& moment, const Export& what) {
  if (const film::Format* film = film::format_of(what.recording)) return film_of(*moment.recording, *film);
  if (moment.recording) return stream::player_page(*moment.recording, moment.title);
  const Result<model::Model> model = model::build(moment.document->scene);
  if (!model) return model.error();
  if (what.kind == Export::Kind::picture) return picture(gpu, moment, *model, what);
  const std::string comment = "t = " + json(moment.time).dump() + " s";
  if (what.kind == Export::Kind::obj) return model::obj_text(*model, moment.positions, comment);
  return model::glb_bytes(*model, moment.document->scene, moment.positions, comment);
}

}  // namespace clothlab::session
