// The laws of finite elements: energy, force and matrices are derivatives of each other, rigid motion costs
// nothing, and simple stretches have their closed forms. Central differences in double precision.
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <random>

#include "server/model/elements.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using elements::Bending;
using elements::Membrane;
using elements::Shell;
using glm::dvec3;

namespace {

template <class Law>
using Corners = std::array<dvec3, elements::corners<Law>>;

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
template <class Law>
Corners<Law> random_field(std::mt19937& random, double size) {
  Corners<Law> field;
  for (dvec3& value : field)
    value = {between(random, -size, size), between(random, -size, size), between(random, -size, size)};
  return field;
}

template <class Law>
elements::Edges<Law> edges(const Corners<Law>& field, std::size_t corner) {
  return elements::make_edges<Law>(
      [&](std::size_t other) { return field[corner] - field[(corner + 1 + other) % field.size()]; });
}
template <class Law>
Law seen(const Law& law, std::size_t corner) {
  return elements::seen_from(law, static_cast<int>(corner));
}

/// A triangle of sides of about 1 m with random shape, material and place of its corners: pulled, sheared,
/// pressed, inverted.
struct RandomMembrane {
  Membrane law;
  Corners<Membrane> place;
};
RandomMembrane random_membrane(std::mt19937& random) {
  const double ax = between(random, 0.5, 1.5), ay = between(random, -0.5, 0.5),
               bx = between(random, -0.5, 0.5), by = between(random, 0.5, 1.5),
               twice_area = ax * by - ay * bx;
  const double warp = between(random, 10, 100), weft = between(random, 10, 100);
  const double coupling = between(random, -0.9, 0.9) * std::sqrt(warp * weft);
  return {{by / twice_area, -bx / twice_area, -ay / twice_area, ax / twice_area, warp, weft, coupling,
           between(random, 1, 50), 0.05},
          random_field<Membrane>(random, 1.0)};
}
Bending random_bending(std::mt19937& random) {
  return {between(random, -50, 50), 0.05};
}

constexpr double h = 1e-5;
// A central difference over h is off by h^2/6 times the next derivative but one and by 2^-52 / h of what it
// subtracts. Numbers here are up to some 1e4 in size, with derivatives as large: 1e4 (h^2 + 2^-52 / h).
constexpr double near = 1e-6;

/// Checks force = -d energy/dx, K = -d force/dx and C = -d force/dv from each corner, and what else a law
/// says of them.
template <class Law>
void check_derivatives(const Law& law, const Corners<Law>& place, const Corners<Law>& velocity) {
  const auto energy = [&](const Corners<Law>& at, std::size_t c) {
    return element_energy(seen(law, c), edges<Law>(at, c));
  };
  const auto force = [&](const Corners<Law>& at, const Corners<Law>& moving, std::size_t c) {
    return element_force(seen(law, c), edges<Law>(at, c), edges<Law>(moving, c));
  };
  const Corners<Law> still{};
  dvec3 sum(0.0);
  for (std::size_t c = 0; c < place.size(); ++c) {
    CHECK(std::abs(energy(place, c) - energy(place, 0)) <= 1e-9);  // every corner sees the same element
    sum += force(place, velocity, c);
    const auto hessian = element_hessian(seen(law, c), edges<Law>(place, c));
    for (std::size_t d = 0; d < place.size(); ++d)
      for (int axis = 0; axis < 3; ++axis) {
        Corners<Law> up = place, down = place, faster = velocity, unit{};
        up[d][axis] += h;
        down[d][axis] -= h;
        faster[d][axis] += 1.0;
        unit[d][axis] = 1.0;
        if (c == d)
          CHECK(std::abs(force(place, still, c)[axis] + (energy(up, c) - energy(down, c)) / (2 * h)) < near);
        const dvec3 stiff = matrix_product(stiffness_matrix(hessian), edges<Law>(unit, c));
        const dvec3 damped = matrix_product(damping_matrix(hessian), edges<Law>(unit, c));
        CHECK(glm::length(stiff + (force(up, still, c) - force(down, still, c)) / (2 * h)) < near);
        CHECK(glm::length(damped + force(place, faster, c) - force(place, velocity, c)) < near);
        // The corner's own block is the product's part of the corner itself.
        if (c != d) continue;
        dvec3 diagonal(0.0), off_diagonal(0.0);
        add_block(stiffness_matrix(hessian), diagonal, off_diagonal);
        const glm::dmat3 block(dvec3(diagonal.x, off_diagonal.x, off_diagonal.y),
                               dvec3(off_diagonal.x, diagonal.y, off_diagonal.z),
                               dvec3(off_diagonal.y, off_diagonal.z, diagonal.z));
        CHECK(glm::length(stiff - block[axis]) < 1e-9);
      }
  }
  CHECK(glm::length(sum) < 1e-9);  // no force on the element as a whole
}

/// Checks what a line search knows of the energy and of the dissipation along a change of velocity.
template <class Law>
void check_line(const Law& law, const Corners<Law>& place, const Corners<Law>& velocity,
                const Corners<Law>& change) {
  constexpr double dt = 0.1, share = 0.7;
  Corners<Law> there = place, then = velocity;
  for (std::size_t c = 0; c < place.size(); ++c) {
    there[c] += dt * share * change[c];
    then[c] += share * change[c];
  }
  const auto damping = damping_matrix(element_hessian(law, edges<Law>(place, 0)));
  const auto dissipated = [&](const Corners<Law>& moving) {  // v.Cv of all corners
    double sum = 0.0;
    for (std::size_t c = 0; c < place.size(); ++c)
      sum += glm::dot(moving[c],
                      matrix_product(damping_matrix(element_hessian(seen(law, c), edges<Law>(place, c))),
                                     edges<Law>(moving, c)));
    return sum;
  };
  (void)damping;
  const double expected = element_energy(law, edges<Law>(there, 0)) -
                          element_energy(law, edges<Law>(place, 0)) +
                          0.5 * dt * (dissipated(then) - dissipated(velocity));
  const auto line = element_line(law, edges<Law>(place, 0), edges<Law>(velocity, 0), edges<Law>(change, 0));
  CHECK(line_energy(law, line, dt, share) == Approx(expected).epsilon(1e-9).margin(1e-9));
}

/// v.Kv over all corners of the definite part of the Hessian.
double work(const Membrane& law, const Corners<Membrane>& place, const Corners<Membrane>& v) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    sum += glm::dot(v[c], matrix_product(stiffness_matrix(element_definite(
                                             element_hessian(seen(law, c), edges<Membrane>(place, c)))),
                                         edges<Membrane>(v, c)));
  return sum;
}

}  // namespace

TEST_CASE("a membrane's force and matrices are the derivatives of its energy, however it is deformed") {
  std::mt19937 random(1);
  for (int n = 0; n < 30; ++n) {
    const auto [law, place] = random_membrane(random);
    check_derivatives(law, place, random_field<Membrane>(random, 1.0));
    check_line(law, place, random_field<Membrane>(random, 1.0), random_field<Membrane>(random, 1.0));
  }
}

TEST_CASE("a flattened and an inverted triangle have the derivatives of their energy, and finite ones") {
  std::mt19937 random(2);
  const Membrane law = random_membrane(random).law;
  const Corners<Membrane> still{};
  check_derivatives(law, {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(2, 0, 0)}, still);  // a line
  check_derivatives(law, {dvec3(0.0), dvec3(0.0), dvec3(0.0)}, still);              // a point
  check_derivatives(law, {dvec3(0, 0, 0), dvec3(0, 1, 0), dvec3(1, 0, 0)}, still);  // turned over
}

TEST_CASE("a pair that bends has a force and matrices that are the derivatives of its energy") {
  std::mt19937 random(3);
  for (int n = 0; n < 10; ++n) {
    const Bending law = random_bending(random);
    check_derivatives(law, random_field<Bending>(random, 1.0), random_field<Bending>(random, 1.0));
    check_line(law, random_field<Bending>(random, 1.0), random_field<Bending>(random, 1.0),
               random_field<Bending>(random, 1.0));
  }
}

TEST_CASE(
    "a vertex pulled along a triangle's normal has a force and matrices that are derivatives of its energy") {
  std::mt19937 random(6);
  for (int n = 0; n < 30; ++n) {
    // Triangles of some 0.5 m^2 and more: the derivatives of smaller ones' normals are beyond `near`.
    Corners<Shell> place{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 0)};
    const auto moved = random_field<Shell>(random, 0.25);
    for (std::size_t c = 0; c < place.size(); ++c) place[c] += (c == 3 ? 4.0 : 1.0) * moved[c];
    // The second half of them flattened below the area under which the normal gets short.
    const Shell law{between(random, -50, 50), between(random, -1, 1), 0.05, n < 15 ? 0.1 : 5.0, 0};
    check_derivatives(law, place, random_field<Shell>(random, 1.0));
    check_line(law, place, random_field<Shell>(random, 0.1), random_field<Shell>(random, 0.1));
    // The bound's quadratic form is at least the element's for any motion, whatever its sign.
    const auto v = random_field<Shell>(random, 1.0);
    double own = 0.0, bound = 0.0;
    for (std::size_t c = 0; c < place.size(); ++c) {
      const auto hessian = element_hessian(seen(law, c), edges<Shell>(place, c));
      own += glm::dot(v[c], matrix_product(stiffness_matrix(hessian), edges<Shell>(v, c)));
      bound += element_bound(hessian).bound * glm::dot(v[c], v[c]);
    }
    CHECK(std::abs(own) <= bound);
  }
}

TEST_CASE("a vertex over a triangle that is a line, a point or far away has a finite force and matrix") {
  const Shell law{2.0, 0.1, 0.05, 0.1, 0};
  const auto check = [&](const Corners<Shell>& place) {
    for (std::size_t c = 0; c < place.size(); ++c) {
      const auto hessian = element_hessian(seen(law, c), edges<Shell>(place, c));
      dvec3 diagonal(0.0), off_diagonal(0.0);
      add_block(stiffness_matrix(hessian), diagonal, off_diagonal);
      const dvec3 force = element_force(seen(law, c), edges<Shell>(place, c), edges<Shell>(place, c));
      // The lever is at most the vertex's distance over least / side: 20 here.
      CHECK(glm::length(force) < 1e3);
      CHECK(glm::length(diagonal) + glm::length(off_diagonal) < 1e4);
      CHECK(std::isfinite(element_energy(seen(law, c), edges<Shell>(place, c))));
    }
  };
  check({dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(2, 0, 0), dvec3(0, 1, 1)});
  check({dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(2, 1e-9, 0), dvec3(0, 1, 1)});
  check({dvec3(0.0), dvec3(0.0), dvec3(0.0), dvec3(0.0)});
  check({dvec3(0.0), dvec3(0.0), dvec3(0.0), dvec3(1.0)});
  Shell padding = law;
  padding.pull = padding.energy = padding.damping = padding.least = 0.0;
  CHECK(element_energy(padding, elements::ShellEdges{}) == 0.0);
  CHECK(element_force(padding, elements::ShellEdges{}, elements::ShellEdges{}) == dvec3(0.0));
}

TEST_CASE(
    "a membrane's matrix without its indefinite part is definite, and the whole one where it is pulled") {
  std::mt19937 random(4);
  int pressed = 0;
  for (int n = 0; n < 200; ++n) {
    const auto [law, place] = random_membrane(random);
    for (int k = 0; k < 5; ++k) {
      const auto v = random_field<Membrane>(random, 1.0);
      CHECK(work(law, place, v) > -1e-9);
    }
    const auto hessian = element_hessian(law, edges<Membrane>(place, 0));
    const dvec3 kept = element_definite(hessian).stress;
    const double least = 0.5 * (hessian.stress.x + hessian.stress.y) -
                         std::hypot(0.5 * (hessian.stress.x - hessian.stress.y), hessian.stress.z);
    if (least >= 0.0)
      CHECK(glm::length(kept - hessian.stress) < 1e-9);
    else
      ++pressed;
    // What is kept has no pressing part, and what is dropped no pulling one.
    const auto least_of = [](const dvec3& s) {
      return 0.5 * (s.x + s.y) - std::hypot(0.5 * (s.x - s.y), s.z);
    };
    CHECK(least_of(kept) > -1e-9);
    CHECK(least_of(kept - hessian.stress) > -1e-9);
  }
  CHECK(pressed > 20);
}

TEST_CASE("a rigid motion of a triangle costs no energy, and a rigid rotation is not damped") {
  std::mt19937 random(5);
  for (int n = 0; n < 20; ++n) {
    const Membrane law = random_membrane(random).law;
    // The rest shape, turned by 90 degrees out of its plane and moved.
    const double inverse = law.first_warp * law.second_weft - law.first_weft * law.second_warp;
    const dvec3 a(law.second_weft / inverse, -law.second_warp / inverse, 0.0),
        b(-law.first_weft / inverse, law.first_warp / inverse, 0.0);
    const auto moved = [](const dvec3& p) { return dvec3(3.0 + p.x, 1.0, -2.0 + p.y); };
    const Corners<Membrane> place{moved(dvec3(0.0)), moved(a), moved(b)};
    const double stretched =
        element_energy(law, edges<Membrane>(Corners<Membrane>{dvec3(0.0), 1.1 * a, 1.1 * b}, 0));
    CHECK(element_energy(law, edges<Membrane>(place, 0)) < 1e-12 * stretched);
    const dvec3 spin = 7.0 * dvec3(0.3, -0.5, 0.8);
    Corners<Membrane> turning;
    for (std::size_t c = 0; c < 3; ++c) turning[c] = glm::cross(spin, place[c]);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(glm::length(element_force(seen(law, c), edges<Membrane>(place, c), edges<Membrane>(turning, c))) <
            1e-10);
  }
}

TEST_CASE(
    "pulled along one thread alone, a membrane has the tension Y l (l^2 - 1) / 2 and the contraction of its "
    "law") {
  // Cotton, on the triangle (0,0) (1,0) (0,1): area 1/2.
  constexpr double warp = 2365, weft = 3801, poisson = 0.311, shear = 97;
  const double scale = 0.5 / (1 - poisson * poisson * weft / warp);
  const Membrane law{1, 0, 0, 1, scale * warp, scale * weft, scale * poisson * weft, 0.5 * shear, 0};
  const auto check = [&](double along, double modulus, double ratio, bool along_warp) {
    // Without stress across, the Green strain across is -ratio times the one along.
    const double strain = 0.5 * (along * along - 1), across = std::sqrt(1 - 2 * ratio * strain);
    const dvec3 a = along_warp ? dvec3(along, 0, 0) : dvec3(across, 0, 0);
    const dvec3 b = along_warp ? dvec3(0, across, 0) : dvec3(0, along, 0);
    const Corners<Membrane> place{dvec3(0.0), a, b};
    // A half of the side of 1 m pulls at each of its ends: the corner's force is the tension a metre over 2.
    const std::size_t corner = along_warp ? 1 : 2;
    const dvec3 force =
        element_force(seen(law, corner), edges<Membrane>(place, corner), elements::MembraneEdges{});
    const double tension = modulus * along * (along * along - 1) / 2;
    CHECK(force[along_warp ? 0 : 1] == Approx(-0.5 * tension).epsilon(1e-12));
    CHECK(std::abs(force[along_warp ? 1 : 0]) < 1e-9 * std::abs(tension));
  };
  for (const double along : {1.1, 1.02, 0.97}) {
    check(along, warp, poisson, true);
    check(along, weft, poisson * weft / warp, false);
  }
  // Simple shear by 0.1: the shear stress is G times 0.1, its pull on the upper corner half of that.
  const Corners<Membrane> sheared{dvec3(0.0), dvec3(1, 0, 0), dvec3(0.1, 1, 0)};
  const dvec3 force =
      element_force(seen(law, std::size_t{2}), edges<Membrane>(sheared, 2), elements::MembraneEdges{});
  const double normal_strain = 0.5 * 0.1 * 0.1;  // along the weft, which is longer
  const double weft_stress = 2 * scale * weft * normal_strain;
  CHECK(force.x == Approx(-0.5 * (shear * 0.1 + 0.1 * weft_stress)).epsilon(1e-12));
}
