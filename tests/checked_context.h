// An OpenGL context whose calls are looked at (server/gl/checked_calls.h).
#pragma once

#include <cstdlib>
#include <memory>
#include <set>
#include <string>

#include "server/gl/checked_calls.h"
#include "server/gl/context.h"
#include "tests/scenes.h"

namespace clothlab::test {

/// A variable of the environment that has this value for as long as the object lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// A context that collects the barriers that are missing.
class BarrierContext {
 public:
  BarrierContext() {
    gl::watch_barriers([this](const std::string& fault) { faults_.insert(fault); });
    const Variable checked("CLOTHLAB_CHECK_BARRIERS", "1");
    context_ = context();
  }
  ~BarrierContext() {
    context_.reset();
    gl::watch_barriers({});
    context();  // later contexts' calls go straight to the driver
  }
  BarrierContext(const BarrierContext&) = delete;
  BarrierContext& operator=(const BarrierContext&) = delete;

  /// Each once.
  const std::set<std::string>& faults() const { return faults_; }

 private:
  std::set<std::string> faults_;
  std::unique_ptr<gl::Context> context_;
};

}  // namespace clothlab::test
