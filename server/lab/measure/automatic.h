// The method "auto": what a scene is stepped with before the lab has chosen, and whether a choice still holds
// for a scene that has been changed since.
#pragma once

#include "server/lab/measure/setting.h"
#include "server/model/model.h"
#include "server/scene/document.h"

namespace clothlab::lab {

/// Verlet at 0.8 of its step limit, or at the scene's own step where nothing limits it: stable, and for most
/// scenes not far from what the lab would choose.
Setting provisional(const model::Model& model, const scene::Scene& scene);

/// The document with those settings in the place of the method "auto"; another document as it is. Error: its
/// model cannot be built.
Result<scene::Document> settled(const scene::Document& document);

/// Numbers of a scene that differ by less than this share are near what was measured.
inline constexpr double same_regime = 0.1;

/// Whether what was measured for `measured` may be relied on for `now`: the same parts and tolerance, and
/// every number that moves the cloth within `same_regime`. Both are scene documents with their defaults
/// filled in.
bool covers(const json& measured, const json& now);

}  // namespace clothlab::lab
