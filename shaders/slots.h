// The names of slots.glsl for C++.
#pragma once

namespace clothlab {
#include "shaders/slots.glsl"
}
