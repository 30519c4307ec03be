// The element laws as C++ functions in double precision: the same files that the kernels include.
#pragma once

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace clothlab::elements {

using real = double;
using vec3 = glm::dvec3;
using glm::cross;
using glm::dot;
using glm::max;
using glm::min;
using std::sqrt;

#define FUNCTION inline
#define OUT(T) T&
#define INOUT(T) T&
#include "shaders/elements/contact.glsl"
#include "shaders/elements/solid.glsl"
#include "shaders/elements/spring.glsl"
#undef FUNCTION
#undef OUT
#undef INOUT

}  // namespace clothlab::elements
