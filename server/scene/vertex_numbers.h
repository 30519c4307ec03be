// The numbers of a mesh's vertices: a document counts those of the mesh's file, everything else those of the
// mesh that became of them, in which vertices at one place are one and those of no face are left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/scene/scene.h"

namespace clothlab::scene {

/// How many vertices a document counts of a mesh: of one from a file, those of the file.
std::size_t counted_vertices(const Mesh& mesh);
/// The vertex of the mesh that became of the one with this number in the document, less than
/// counted_vertices; mesh::no_vertex: it is part of no face.
std::uint32_t vertex_of(const Mesh& mesh, std::uint32_t number);
/// The numbers in frames of those from `first` to before `end`, at most counted_vertices, of a cloth whose
/// own begin at `first_vertex`; mesh::no_vertex of one that is part of no face.
std::vector<std::uint32_t> numbers_in_frames(const Mesh& mesh, std::uint32_t first_vertex, std::size_t first,
                                             std::size_t end);
/// True if a document gives some vertex another number than the mesh.
bool renumbered(const Mesh& mesh);

}  // namespace clothlab::scene
