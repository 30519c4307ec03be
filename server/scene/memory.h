// What documents and scenes take of the process's memory [bytes], with what the allocator adds to each piece.
#pragma once

#include <cstddef>

#include "server/scene/document.h"

namespace clothlab::scene {

std::size_t memory_of(const json& value);
/// Meshes that it shares with other scenes count in full.
std::size_t memory_of(const Scene& scene);

}  // namespace clothlab::scene
