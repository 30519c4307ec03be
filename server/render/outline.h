// What a collider covers in a picture, for the framing.
#pragma once

#include <vector>

#include "server/render/camera.h"
#include "server/scene/scene.h"

namespace clothlab::render {

/// Balls whose convex hull is that of the shape; none if it is infinite.
std::vector<Ball> outline(const scene::Shape& shape);

}  // namespace clothlab::render
