// Mesa's displays for its software device, which each have their own helper threads (software.h); for
// context.cpp. All functions but `check_software` need egl_mutex().
#pragma once

#include <glad/egl.h>

#include <mutex>
#include <optional>

#include "server/gl/software/software.h"

namespace clothlab::gl::software {

/// True if CLOTHLAB_PLAY_GPU=1.
bool plays_gpu();
/// Ends the program if a GPU is played: `what` is not to be asked of one.
void check_software(const char* what);

/// The display of software OpenGL's device (null: the surfaceless platform) whose contexts share `threads`.
EGLDisplay display_of(EGLDeviceEXT device, HelperThreads threads);
/// To be called when a display has been opened: Mesa has read LP_NUM_THREADS if it had not been open before.
void opened(EGLDisplay display);
/// If the program began with `compute_without_helper_threads`, opens the display anew unless it computes
/// with, or without, helper threads as wanted. Waits until no context of it exists.
void reopen(EGLDisplay display, bool helped, std::unique_lock<std::mutex>& lock);
void context_made(EGLDisplay display);
void context_gone(EGLDisplay display);
/// Keeps what Context::create(gpu) has found.
void note_device(std::optional<int> gpu, bool is_software);

}  // namespace clothlab::gl::software
