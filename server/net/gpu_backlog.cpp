#include "server/net/gpu_backlog.h"

namespace clothlab::net {

GpuBacklog::~GpuBacklog() {
  while (!empty()) pop();
}

void GpuBacklog::push(std::uint32_t steps, Time begun) {
  batches_[(first_ + count_) % batches_.size()] = {glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), steps,
                                                   begun};
  ++count_;
}

bool GpuBacklog::finished() {
  if (empty()) return false;
  const GLenum state = glClientWaitSync(batches_[first_].fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
  return state != GL_TIMEOUT_EXPIRED;
}

void GpuBacklog::pop() {
  glDeleteSync(batches_[first_].fence);
  first_ = (first_ + 1) % batches_.size();
  --count_;
}

}  // namespace clothlab::net
