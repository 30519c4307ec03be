// The spring's energy, force and Hessian are derivatives of each other: central differences in double
// precision.
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>

#include "shaders/elements/elements.h"
#include "tests/catch.h"
#include "tests/spring_laws.h"

using namespace clothlab;
using glm::dmat3;
using glm::dvec3;

namespace {

struct Spring {
  dvec3 x, y;
  double rest;
};

constexpr double stiffness = 300.0;
constexpr double rounding = 0x1p-52;

dvec3 random_vector(std::mt19937& random) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  return {either(random), either(random), either(random)};
}

/// A spring from a random place in a random direction, `length` long.
Spring spring_of(std::mt19937& random, double length, double rest) {
  const dvec3 x = random_vector(random);
  return {x, x + length * glm::normalize(random_vector(random)), rest};
}

double energy(const Spring& s, const dvec3& x) {
  return test::spring_energy(x, s.y, s.rest, stiffness);
}
dvec3 force(const Spring& s, const dvec3& x) {
  return test::spring_force(x, s.y, dvec3(0.0), dvec3(0.0), s.rest, stiffness, 7.0);
}
dmat3 hessian(const Spring& s) {
  dvec3 n;
  double along, across;
  test::spring_hessian(s.x, s.y, s.rest, stiffness, n, along, across);
  dmat3 matrix;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      matrix[column][row] = (along - across) * n[row] * n[column] + (row == column ? across : 0.0);
  return matrix;
}

/// Checks -dE/dx = f and -df/dx = H. A central difference over h is off by h^2/6 times the third derivative
/// and by the rounding of what it subtracts over h. With l the length and r the rest length, the third
/// derivative of the energy is at most 3 k r / l^2, that of the force 15 k r / l^3; h is chosen small against
/// l.
void check_derivatives(const Spring& s) {
  const double length = glm::distance(s.x, s.y), size = 2.0 + length + s.rest;
  const double h = 1e-4 * length, moved = rounding * size / h;  // error of x + h, relative to h
  const double energy_bound =
      h * h / 6 * 3 * stiffness * s.rest / (length * length) + 4 * stiffness * (length + s.rest) * moved;
  const double force_bound = h * h / 6 * 15 * stiffness * s.rest / (length * length * length) * 2 +
                             8 * stiffness * (1 + s.rest / length) * moved;
  const dvec3 f = force(s, s.x);
  const dmat3 matrix = hessian(s);
  for (int axis = 0; axis < 3; ++axis) {
    dvec3 up = s.x, down = s.x;
    up[axis] += h;
    down[axis] -= h;
    INFO("length " << length << " m, rest " << s.rest << " m, axis " << axis);
    CHECK(std::abs((energy(s, up) - energy(s, down)) / (2 * h) + f[axis]) < energy_bound);
    CHECK(glm::length((force(s, up) - force(s, down)) / (2 * h) + matrix[axis]) < force_bound);
    CHECK(energy_bound < 1e-4 * stiffness * (length + s.rest));  // the bounds are small enough to find errors
    CHECK(force_bound < 1e-4 * stiffness * (1 + s.rest / length));
  }
}

}  // namespace

TEST_CASE("a spring's force and Hessian are the derivatives of its energy at random lengths") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.2, 3.0);
  for (int round = 0; round < 300; ++round) check_derivatives(spring_of(random, 0.7 * share(random), 0.7));
}

TEST_CASE("a spring's force and Hessian are the derivatives of its energy at rest, where the force is 0") {
  std::mt19937 random(12);
  for (int round = 0; round < 100; ++round) {
    const Spring s = spring_of(random, 0.7, 0.7);
    check_derivatives(s);
    CHECK(glm::length(force(s, s.x)) < stiffness * 16 * rounding);
  }
}

TEST_CASE(
    "a spring's force and Hessian are the derivatives of its energy far compressed and nearly without "
    "length") {
  std::mt19937 random(13);
  for (const double length : {0.3, 0.01, 1e-4})
    for (int round = 0; round < 100; ++round) check_derivatives(spring_of(random, length, 0.7));
  for (int round = 0; round < 100; ++round)
    check_derivatives(spring_of(random, 0.5, 0.0));  // a zero rest length
}

TEST_CASE("moving a spring rigidly turns its force and Hessian with it, and leaves its energy") {
  std::mt19937 random(14);
  for (int round = 0; round < 100; ++round) {
    const Spring s = spring_of(random, 0.4, 0.7);
    // The matrix of a rotation, from two random directions made orthonormal.
    const dvec3 a = glm::normalize(random_vector(random));
    const dvec3 b = glm::normalize(glm::cross(a, random_vector(random)));
    const dmat3 turn(a, b, glm::cross(a, b));
    const dvec3 shift = 5.0 * random_vector(random);
    const Spring moved{turn * s.x + shift, turn * s.y + shift, s.rest};
    check_derivatives(moved);
    const double bound = 1000 * rounding * stiffness;  // numbers up to 10, divided by lengths of 0.4
    CHECK(std::abs(energy(moved, moved.x) - energy(s, s.x)) < bound);
    CHECK(glm::length(force(moved, moved.x) - turn * force(s, s.x)) < bound);
    const dmat3 turned = turn * hessian(s) * glm::transpose(turn), found = hessian(moved);
    for (int column = 0; column < 3; ++column) CHECK(glm::length(found[column] - turned[column]) < 4 * bound);
  }
}

TEST_CASE(
    "a compressed spring's Hessian is negative across it, a stretched one's is positive, and along it both "
    "are k") {
  dvec3 n;
  double along, across;
  test::spring_hessian({0.0, 0.0, 0.0}, {0.0, 0.0, 0.5}, 1.0, stiffness, n, along, across);
  CHECK(n == dvec3(0.0, 0.0, -1.0));
  CHECK(along == stiffness);
  CHECK(across == -stiffness);
  test::spring_hessian({0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, 1.0, stiffness, n, along, across);
  CHECK(along == stiffness);
  CHECK(across == 0.5 * stiffness);
}

TEST_CASE("a spring without length has the Hessian of no direction: k times the unit matrix, and no NaN") {
  const dvec3 x(0.3, 0.2, 0.1);
  const dmat3 matrix = hessian({x, x, 0.5});
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) CHECK(matrix[column][row] == (row == column ? stiffness : 0.0));
}
