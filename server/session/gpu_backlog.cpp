#include "server/session/gpu_backlog.h"

namespace clothlab::session {

GpuBacklog::~GpuBacklog() {
  while (!empty()) pop();
}

void GpuBacklog::push(const Piece& piece) {
  queued_[(first_ + count_) % queued_.size()] = {glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), piece};
  ++count_;
}

bool GpuBacklog::finished() {
  if (empty()) return false;
  const GLenum state = glClientWaitSync(queued_[first_].fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
  return state != GL_TIMEOUT_EXPIRED;
}

void GpuBacklog::pop() {
  glDeleteSync(queued_[first_].fence);
  first_ = (first_ + 1) % queued_.size();
  --count_;
}

}  // namespace clothlab::session
