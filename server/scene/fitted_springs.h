// Springs that act as a sheet of finite elements, as far as springs can.
#pragma once

#include "server/scene/scene.h"

namespace clothlab::scene {

/// The springs of a square grid with `spacing` [m] that come nearest to `sheet`, which weighs `area_density`
/// [kg/m^2]. Of such a grid's springs, a metre of width resists strain along rows or columns with
/// structural + shear + 4 bend, strain in both directions at once with shear more, and a slant of the threads
/// with shear (energies summed over a cell, Provot 1995's grid). So:
///
/// * shear is the sheet's;
/// * structural makes a strip, pulled along its threads, as stiff as the sheet is along warp and weft on
///   (geometric) average;
/// * bend gives the sheet's energy of bending at one curvature: that at which the sheet folds under its own
///   weight, or a radian a spacing where the grid cannot show it;
/// * damping is the sheet's of slanting or of stretching, whichever is weaker; of all other motions it is too
///   weak.
///
/// Lost are the difference of warp and weft, the grain, Poisson's ratio (it follows from shear: a soft knit's
/// comes out too large), and bending itself: a spring to the second neighbour resists small curvatures not at
/// all, large ones more than in proportion, no twist, and bending along the diagonal with an eighth.
/// No stiffness is ever negative. Bend never stiffens the sheet by more than half of what is structural: on a
/// fine grid (where it would) the springs are softer than the sheet when bent.
Springs springs_like(const Fem& sheet, double spacing, double area_density);

/// Area of the mesh at rest [m^2], of its flat pattern if it has one, at a transform's scale of 1.
double area(const Mesh& mesh);

/// Spacing [m] of the square grid with as many vertices on the same area, at a transform's scale of 1.
double grid_spacing(const Mesh& mesh);

}  // namespace clothlab::scene
