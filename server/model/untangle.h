// What undoes crossings of cloth with cloth. Internal to dress.cpp.
//
// Crossings lie on contours, the lines along which surfaces meet (Baraff, Witkin & Kass 2003, "Untangling
// cloth"). Where a contour cuts a region off its piece of cloth, the smaller region goes back to the side of
// the larger one. Where it cuts off none, the crossing edge goes the way that shortens the contour (Volino &
// Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour minimization").
#pragma once

#include <vector>

#include "server/model/crossings.h"
#include "server/model/dress_cloth.h"

namespace clothlab::model {

/// Adds what the cloth in these crossings demands, those with bodies left out: to be `clearance` [m] apart on
/// the right side, or `step` [m] along the way that shortens a contour. Cloth that crosses nothing demands to
/// stay on its side of what is near, as a vertex moves by `step` at most.
void demand_untangled(const DressCloth& cloth, const std::vector<Crossing>& crossings, double clearance,
                      double step, std::vector<Demand>& demands);

}  // namespace clothlab::model
