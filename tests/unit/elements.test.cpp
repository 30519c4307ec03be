// The element laws in double precision, from the files that the kernels include.
#include <cmath>
#include <random>

#include "shaders/elements/elements.h"
#include "tests/catch.h"
#include "tests/spring_laws.h"

using namespace clothlab;
using glm::dvec3;

namespace {

dvec3 random_vector(std::mt19937& random) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  return {either(random), either(random), either(random)};
}

}  // namespace

TEST_CASE("the spring's force is minus the gradient of its energy") {
  std::mt19937 random(1);
  for (int round = 0; round < 100; ++round) {
    const dvec3 x = random_vector(random), y = random_vector(random), none(0.0);
    const double rest = 0.7, k = 300.0, h = 1e-5;
    const dvec3 force = test::spring_force(x, y, none, none, rest, k, 5.0);
    for (int axis = 0; axis < 3; ++axis) {
      dvec3 up = x, down = x;
      up[axis] += h;
      down[axis] -= h;
      const double slope =
          (test::spring_energy(up, y, rest, k) - test::spring_energy(down, y, rest, k)) / (2 * h);
      // Central difference: h^2 times the third derivative, which is of the order of k rest / length^3.
      const double length = glm::distance(x, y);
      CHECK(std::abs(force[axis] + slope) < h * h * k * 10 / (length * length * length) + 1e-8);
    }
  }
}

TEST_CASE("the two ends of a spring feel opposite forces") {
  std::mt19937 random(2);
  for (int round = 0; round < 100; ++round) {
    const dvec3 x = random_vector(random), y = random_vector(random), v = random_vector(random),
                w = random_vector(random);
    CHECK(test::spring_force(x, y, v, w, 0.5, 100.0, 3.0) ==
          -test::spring_force(y, x, w, v, 0.5, 100.0, 3.0));
  }
}

TEST_CASE("a rigid rotation feels zero damping, about any axis") {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    const dvec3 x = random_vector(random), y = random_vector(random), turning = 10.0 * random_vector(random);
    const double length = glm::distance(x, y);
    const dvec3 force =
        test::spring_force(x, y, glm::cross(turning, x), glm::cross(turning, y), length, 0.0, 1000.0);
    CHECK(glm::length(force) <
          1000.0 * glm::length(turning) * 2 * 0x1p-50);  // roundings of a dot product that is 0
  }
}

TEST_CASE("damping is along the spring: only the part of the relative velocity on it counts") {
  const dvec3 x(0.0), y(2.0, 0.0, 0.0);
  const dvec3 force = test::spring_force(x, y, dvec3(3.0, 7.0, -5.0), dvec3(1.0, 0.0, 0.0), 2.0, 0.0, 10.0);
  CHECK(force == dvec3(-20.0, 0.0, 0.0));
}

TEST_CASE("a spring without length gives no force and no NaN") {
  const dvec3 x(0.3, 0.2, 0.1);
  CHECK(test::spring_force(x, x, dvec3(1.0), dvec3(0.0), 0.0, 100.0, 10.0) == dvec3(0.0));
  CHECK(test::spring_force(x, x, dvec3(1.0), dvec3(0.0), 0.5, 100.0, 10.0) == dvec3(0.0));
  CHECK(test::spring_strain(x, x, 0.0) == 0.0);
}

TEST_CASE("friction stops a slow slide, slows a fast one by the Coulomb impulse, and never turns it back") {
  const dvec3 n(0.0, 1.0, 0.0);
  CHECK(elements::contact_velocity({0.2, -1.0, 0.0}, n, 0.3, 0.0) == dvec3(0.0));
  const dvec3 kept = elements::contact_velocity({4.0, -1.0, 3.0}, n, 0.5, 0.0);  // speed 5, loses 0.5
  CHECK(glm::distance(kept, dvec3(3.6, 0.0, 2.7)) < 1e-15);
  CHECK(elements::contact_velocity({1.0, -2.0, 0.0}, n, 0.0, 0.5) == dvec3(1.0, 1.0, 0.0));
  CHECK(elements::contact_velocity({1.0, 2.0, 0.0}, n, 0.5, 0.5) == dvec3(1.0, 2.0, 0.0));  // moving away
}

TEST_CASE("no path ends inside a sphere, wherever it starts and however long it is") {
  std::mt19937 random(4);
  int met = 0;
  for (int round = 0; round < 20000; ++round) {
    const double reach = std::pow(10.0, static_cast<double>(random() % 5) - 2.0);
    const dvec3 from = 1.5 * random_vector(random), to = from + reach * random_vector(random);
    dvec3 stopped, normal;
    const bool contact = elements::sphere_contact(from, to, 1.0, stopped, normal);
    met += contact;
    CHECK(glm::length(stopped) >= 1.0 - 1e-12);
    if (!contact) CHECK(stopped == to);
    if (contact) CHECK(glm::length(normal) == Approx(1.0));
    // A path that starts outside does not come out behind: it stays on its side of the tangent plane.
    if (contact && glm::length(from) > 1.0) CHECK(glm::dot(stopped, normal) >= 1.0 - 1e-12);
  }
  CHECK(met > 3000);
}
