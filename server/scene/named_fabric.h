// What a document leaves to the fabrics that it names: numbers that are in the scene and not in the document,
// so that the name of another fabric changes them.
#pragma once

#include "server/scene/document.h"

namespace clothlab::scene {

/// For each cloth the numbers that it leaves to its fabric, as a merge patch of the cloth ("material" and
/// perhaps "mass"); null for a cloth that names none.
json left_to_fabrics(const Document& document);

/// The document with those numbers written into it, for code that changes numbers of the document.
json spelled_out(const Document& document);

/// After a patch that names a fabric for a cloth that had none: takes out what the program itself wrote into
/// the document before, the material's and the mass's defaults, as nobody asked for these numbers.
void give_way_to_fabrics(const json& before, json& after);

}  // namespace clothlab::scene
