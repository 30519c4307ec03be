// The method "auto": the setting that steps a scene until the lab has chosen one, and whether a choice made
// for a scene still holds after the scene was changed.
#pragma once

#include "server/lab/measure/setting.h"
#include "server/model/model.h"
#include "server/scene/document.h"

namespace clothlab::lab {

/// The setting used until the lab has chosen: Verlet at 0.8 of its step limit, or at the scene's own step
/// where there is no limit. It is stable, and for most scenes not far from what the lab would choose.
Setting provisional(const model::Model& model, const scene::Scene& scene);

/// The document with the provisional setting instead of the method "auto"; a document with another method is
/// returned unchanged. Error: the model of its scene cannot be built.
Result<scene::Document> with_provisional_setting(const scene::Document& document);

/// A measurement of one scene holds for another if all their numbers differ by at most this share.
inline constexpr double covered_difference = 0.1;

/// True if a choice measured for the scene `measured` still holds for the scene `now`: both have the same
/// parts, method and tolerance, and every number that affects the motion agrees within `covered_difference`.
/// Both are scene documents with their defaults filled in.
bool covers(const json& measured, const json& now);

}  // namespace clothlab::lab
