// For tests: looks at the calls of OpenGL that use buffers before the driver gets them.
//   CLOTHLAB_CHECK_BARRIERS=1       finds barriers that are missing (access_check.h). The program ends at the
//                                   first, as under a sanitizer, and says what is missing between what
//   CLOTHLAB_GROUP_ORDER=reversed   work groups of compute programs change places: the first does the last
//                                   one's work. A program that depends on their order shows it
// in the environment when a context is made. Without them all calls go straight to the driver.
#pragma once

#include <glad/gl.h>

#include <functional>
#include <string>

namespace clothlab::gl {

/// The function of this name, for gladLoadGL: the driver's, or one of ours before it.
GLADapiproc function_of(const char* name);

/// To be called when a context has been made, and is current: nothing of it is known yet.
void begin_context_checks();

/// From now on `told` is told of each fault in place of the program's end; empty: it ends again.
void watch_barriers(std::function<void(const std::string& fault)> told);

}  // namespace clothlab::gl
