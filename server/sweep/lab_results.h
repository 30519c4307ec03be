// The points of a group as results of the lab, which it can draw.
#pragma once

#include "server/lab/measure/chart.h"
#include "server/lab/measure/stability_map.h"
#include "server/sweep/groups.h"

namespace clothlab::sweep {

/// Error against cost. The points of the group may differ in their setting alone.
lab::Chart lab_chart(const Plan& plan, const Cells& cells, const Group& group);

/// Where steps blow up over `axis`, whose values are numbers at places of the scene. The points of the group
/// may differ in their method, in dt and on this axis. Growth compares the largest kinetic + elastic energies
/// at the looks (`every`) with that of the shortest step that held.
lab::StabilityMap lab_map(const Plan& plan, const Cells& cells, const Group& group, const Axis& axis);

}  // namespace clothlab::sweep
