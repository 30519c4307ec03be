#include "server/gl/stage_timer.h"

namespace clothlab::gl {

StageTimer::~StageTimer() {
  if (marks_[0] != 0) glDeleteQueries(static_cast<GLsizei>(marks_.size()), marks_.data());
}

void StageTimer::begin() {
  if (state_ != State::idle) return;
  if (marks_[0] == 0) glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(marks_.size()), marks_.data());
  stages_ = 0;
  state_ = State::running;
  glQueryCounter(marks_[0], GL_TIMESTAMP);
}

void StageTimer::stage(const char* name) {
  if (state_ != State::running || stages_ == most_stages) return;
  names_[stages_] = name;
  glQueryCounter(marks_[++stages_], GL_TIMESTAMP);
}

void StageTimer::end() {
  if (state_ == State::running) state_ = stages_ > 0 ? State::waiting : State::idle;
}

void StageTimer::poll(StageTimes& out) {
  if (state_ != State::waiting) return;
  GLint arrived = 0;
  glGetQueryObjectiv(marks_[stages_], GL_QUERY_RESULT_AVAILABLE, &arrived);
  if (!arrived) return;
  state_ = State::idle;
  GLuint64 before = 0;
  glGetQueryObjectui64v(marks_[0], GL_QUERY_RESULT, &before);
  for (std::size_t i = 0; i < stages_; ++i) {
    GLuint64 now = 0;
    glGetQueryObjectui64v(marks_[i + 1], GL_QUERY_RESULT, &now);
    // Some GPUs' clocks restart when the GPU wakes: the difference is then no duration.
    if (now >= before) out.add({names_[i], 1e-9 * static_cast<double>(now - before)});
    before = now;
  }
}

}  // namespace clothlab::gl
