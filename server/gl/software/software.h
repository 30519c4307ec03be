// All that is for software OpenGL alone (Mesa's llvmpipe and softpipe), by its only header: which threads
// compute, whose turn it is, whether a dispatch would do nothing, how large a work group is. A GPU comes no
// further than the two questions at the top: who answers "no" asks nothing else here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace clothlab::gl {

class Buffer;

/// True if the calling thread's current context is one of Mesa's software rasteriser. CLOTHLAB_PLAY_GPU=1 in
/// the environment, for tests, makes it a GPU in all that the program does, and ends the program where
/// anything below is asked all the same.
bool software_renderer();

/// True if Context::create(gpu) takes software OpenGL; found out once. Afterwards no context may be current.
bool software_device(std::optional<int> gpu);

/// Software OpenGL computes on helper threads, which all contexts of one EGL display share. They carry out
/// one dispatch after another, however long, at the priority of the thread that made the display's first
/// context. Mesa has four displays for its software device; each value names the contexts that share one.
/// `none`, `none_too`: contexts compute on the thread that calls, one after another on each display, if the
/// program began with `compute_without_helper_threads`. `lab`: see `helped` of Context::create.
enum class HelperThreads { none, none_too, sessions, lab };

/// From now on contexts of `none` and `none_too` compute on the thread that calls; those of the other
/// displays on as many helper threads as the environment's LP_NUM_THREADS says, by default one for each core.
/// Mesa reads that variable when it opens a display: so this opens the other displays, then sets it to 0.
/// Must be called before the program's first context and its first thread. No effect where there is a GPU.
void compute_without_helper_threads();

/// True if the calling thread's current context is one of software OpenGL without helper threads: a dispatch
/// then costs a few microseconds besides its work, else several times that.
bool computes_on_calling_thread();

/// What computes, where the current context is one of software OpenGL: its threads and the processor. What is
/// measured of it (device_fact.h) depends on both.
std::string what_computes();

/// True if software OpenGL steps a cloth of so many vertices faster on the thread that calls than on helper
/// threads, whose start and end take longer than they save.
bool needs_no_helper_threads(std::size_t vertices);

/// Creates the helper threads of `sessions` at nice 5, or those of `lab` at nice 19, the lowest priority.
/// They inherit the priority of the thread that makes the first context for them: so call this before any
/// other context of `threads`. Every call after the first, and one for another display or a GPU, does
/// nothing.
void make_helper_threads(std::optional<int> gpu, HelperThreads threads);

/// Where a scene that is to run in real time is computed: a claim to a part of a display's time, given up at
/// the end of its life. Scenes that one core surely steps in real time are spread over the two displays whose
/// contexts compute on the thread that calls. Heavier ones share the helper threads of `sessions`.
class ComputePlace {
 public:
  /// For a scene that takes this share of one core's time. Of the displays without helper threads it takes
  /// the one of which least is claimed.
  static ComputePlace claim(double share);
  ComputePlace(ComputePlace&& other) noexcept;
  ComputePlace& operator=(ComputePlace&& other) noexcept;
  ~ComputePlace();

  /// True if a changed scene, of another share, may stay here, as it does near the boundary; then it claims
  /// as much as it takes.
  bool stays(double share);

  HelperThreads threads() const { return threads_; }

 private:
  ComputePlace(HelperThreads threads, double share);
  HelperThreads threads_;
  double share_;  ///< of one core
};

/// A turn to compute on a display that sessions share. Without turns Mesa lets the contexts of a display
/// alternate at every dispatch, and each finds its code and its cloth gone from the processor's caches. Turns
/// go round in the order in which they are asked for. One that takes long ends early if others wait, and its
/// holder computes on beside them.
class [[nodiscard]] DisplayTurn {
 public:
  /// Waits until it is this one's turn.
  explicit DisplayTurn(HelperThreads display);
  ~DisplayTurn();
  DisplayTurn(const DisplayTurn&) = delete;
  DisplayTurn& operator=(const DisplayTurn&) = delete;

  /// Number of turns that wait for the display now.
  static std::size_t waiting(HelperThreads display);
  /// Number of others that waited when it began.
  std::uint32_t others() const { return others_; }

 private:
  HelperThreads display_;
  std::uint32_t others_ = 0;
};

/// Whether the device can be asked between two dispatches. Software OpenGL has carried out a dispatch when
/// the call returns, and is asked: that costs less than a dispatch that does nothing. A GPU would have to be
/// waited for.
class AnswersAtOnce {
 public:
  AnswersAtOnce() = default;  ///< it does not
  /// Of the calling thread's current context.
  static AnswersAtOnce of_device();
  explicit operator bool() const { return answers_; }
  /// True if an indirect dispatch of the groups at this offset of the buffer would do nothing; false where
  /// that would have to be waited for.
  bool none(const Buffer& arguments, std::size_t offset) const;

 private:
  bool answers_ = false;
};

/// The threads of a work group that does a whole step alone. Software OpenGL runs 8 at a time, and each
/// barrier costs more with more threads; but it silently ends every loop of a kernel after 65535 turns in all
/// (gallivm's LP_MAX_TGSI_LOOP_ITERATIONS). So these are the fewest, 8 to 128, with which the `turns` in one
/// thread stay well below that; 0 if there are none.
std::uint32_t fewest_lanes(const std::function<std::uint64_t(std::uint32_t threads)>& turns);

}  // namespace clothlab::gl
