// What a scene takes of the process's memory while it is simulated, by its size, before anything is built.
#pragma once

#include <cstdint>
#include <memory>

#include "server/base/memory_budget.h"
#include "server/scene/scene.h"

namespace clothlab::sim {

/// The most that its simulation takes [bytes], its building and the frames of every form included, where the
/// device computes in the process's memory. Upper bounds from measurements (tests/bench/memory.mjs).
std::uint64_t expected_memory(const scene::Scene& scene);

/// True of an error of `reserve_memory`.
bool is_lack_of_memory(const Error& error);

/// Reserves that much for a simulation. Error, for users: what the scene needs, and what is left.
Result<MemoryBudget::Reservation> reserve_memory(const std::shared_ptr<MemoryBudget>& budget,
                                                 const scene::Scene& scene);

}  // namespace clothlab::sim
