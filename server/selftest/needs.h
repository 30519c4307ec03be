// What programs need of a device, as reflection tells it of those that it has linked, against what the device
// allows.
#pragma once

#include <glad/gl.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/gl/program.h"
#include "server/selftest/report.h"

namespace clothlab::selftest {

/// Collects the needs of the calling thread's programs while it lives.
class ProgramWatch {
 public:
  ProgramWatch();
  ~ProgramWatch();
  ProgramWatch(const ProgramWatch&) = delete;
  ProgramWatch& operator=(const ProgramWatch&) = delete;

  /// The number of programs that have been linked so far, each once.
  std::size_t linked() const { return linked_.size(); }

  /// A check for each limit: the most that a program needs, by its name, at most what the device allows.
  std::vector<Check> limits() const;

 private:
  struct Most {
    GLint needed = 0;
    std::string program = "no program";
  };
  void add(const std::string& path, const gl::Defines& defines, const Result<gl::Program>& loaded);
  void measure(const std::string& path, GLuint id);
  void need(const char* what, GLint count, const std::string& program);

  std::set<std::string> linked_;      ///< path and defines
  std::map<std::string, Most> most_;  ///< by the limit's name
};

}  // namespace clothlab::selftest
