// What mesh.upload answers of a mesh: what is in it, and what its use can be guessed from.
#pragma once

#include <string>

#include "server/scene/assets.h"
#include "server/scene/document.h"

namespace clothlab::session {

/// Of an uploaded file of so many bytes, and of its named parts, which are read from `assets` one by one.
/// Numbers of vertices are those of the file.
scene::json mesh_facts(const std::string& name, const mesh::Mesh& mesh, const scene::Assets& assets,
                       std::size_t bytes);

}  // namespace clothlab::session
