// Faults on purpose, for tests of failures that cannot be provoked from outside. The environment variable
// CLOTHLAB_FAULT=KIND:SESSION:STEPS causes one fault of this kind in the session, once it has made the steps.
#pragma once

#include <cstdint>
#include <string>

namespace clothlab::session {

enum class Fault {
  exception,     ///< "exception": the session's thread throws
  no_memory,     ///< "no-memory": an allocation fails between steps
  change_fails,  ///< "change-fails": an allocation fails while a changed scene is prepared; SESSION is empty
  context_lost   ///< "context-lost": the OpenGL context is reset
};

/// The values of SESSION for a fault in the lab, in the exporter or in a command that steps a scene: names
/// that no session can have. STEPS is a job's number, or 0, of the first two.
inline constexpr const char *fault_in_lab = "/lab", *fault_in_exporter = "/export", *fault_in_run = "/run";

/// True once: when kind, session and steps are those that the environment asks for.
bool fault_due(Fault fault, const std::string& session, std::uint64_t steps);
/// Throws if the fault `exception` or `no_memory` is due.
void provoke_fault(const std::string& session, std::uint64_t steps);

}  // namespace clothlab::session
