// What a result of the lab depends on in a scene.
#pragma once

#include "server/base/hash.h"
#include "server/scene/document.h"

namespace clothlab::lab {

/// Adds the scene with the meshes that it names, without what does not change its motion: names, colours and
/// textures.
void add_scene(Hash& hash, const scene::Document& document);

}  // namespace clothlab::lab
