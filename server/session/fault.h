// Faults on purpose, for tests of what cannot be provoked from outside: CLOTHLAB_FAULT=KIND:SESSION:STEPS in
// the environment makes that session meet it once it has made so many steps, the first time only.
#pragma once

#include <cstdint>
#include <string>

namespace clothlab::session {

enum class Fault {
  exception,     ///< "exception": its thread throws
  no_memory,     ///< "no-memory": an allocation fails between steps
  change_fails,  ///< "change-fails": an allocation fails while a changed scene is adopted
  context_lost   ///< "context-lost": the OpenGL context is reset
};

/// The lab's and the exporter's place among the sessions: names that no session can have. STEPS is then a
/// job's number, or 0.
inline constexpr const char *fault_in_lab = "/lab", *fault_in_exporter = "/export";

/// True once, where the environment asks for it.
bool fault_due(Fault fault, const std::string& session, std::uint64_t steps);
/// Throws what `exception` and `no_memory` ask for, when it is due.
void provoke_fault(const std::string& session, std::uint64_t steps);

}  // namespace clothlab::session
