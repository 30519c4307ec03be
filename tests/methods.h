// The methods under which a claim about every method is tried.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "server/scene/method.h"
#include "tests/catch.h"

namespace clothlab::test {

/// True of each method if thorough. Otherwise of one of each family, whose members share most of their code:
/// methods that add forces up, that solve, that move constraints and that move vertices. `physics: order`,
/// `surface_contact` and the scenes of the selftest (`barriers`) try all methods in any case.
inline bool tried(scene::Method method) {
  using scene::Method;
  return thorough() || method == Method::symplectic_euler || method == Method::implicit_euler ||
         method == Method::xpbd || method == Method::vbd;
}

/// Those of `methods` that are tried.
template <class Methods>
std::vector<scene::Method> tried_of(const Methods& methods) {
  std::vector<scene::Method> found;
  std::copy_if(std::begin(methods), std::end(methods), std::back_inserter(found), tried);
  return found;
}

}  // namespace clothlab::test
