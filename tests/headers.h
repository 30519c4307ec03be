// The headers that most tests include, precompiled for all of them (tests/CMakeLists.txt).
#pragma once

#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "server/reference/reference.h"
#include "server/sim/simulation.h"
#include "tests/catch.h"
#include "tests/scenes.h"
