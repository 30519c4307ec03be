#include "server/model/orientation.h"

#include <cmath>
#include <cstddef>

namespace clothlab::model {

namespace {

constexpr double unit = 0x1p-53;  // half the distance from 1 to the next number
// Shewchuk's bounds of the error, as a share of the sum of all products' sizes.
constexpr double turn_error = (3.0 + 16.0 * unit) * unit;
constexpr double side_error = (7.0 + 56.0 * unit) * unit;

int sign(double x) {
  return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
}

/// a + b = sum + error, exactly.
struct Sum {
  double sum, error;
  Sum(double a, double b) : sum(a + b) {
    const double of_b = sum - a, of_a = sum - of_b;
    error = (a - of_a) + (b - of_b);
  }
};

/// A sum of doubles, kept exactly as one of doubles that do not overlap, the smallest first.
class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const Sum next(x, terms_[i]);
      if (next.error != 0.0) terms_[kept++] = next.error;
      x = next.sum;
    }
    if (x != 0.0) terms_[kept++] = x;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  void add_product(double a, double b, double c) {
    const double product = a * b;
    add_product(std::fma(a, b, -product), c);
    add_product(product, c);
  }
  int sign() const { return size_ == 0 ? 0 : model::sign(terms_[size_ - 1]); }

 private:
  std::array<double, 96> terms_{};  // of 24 products of three doubles, four terms each
  std::size_t size_ = 0;
};

bool exact_difference(const dvec3& a, const dvec3& b) {
  for (int i = 0; i < 3; ++i)
    if (Sum(a[i], -b[i]).error != 0.0) return false;
  return true;
}

/// Adds sign * dot(cross(u, v), w).
void add_determinant(Expansion& to, double sign, const dvec3& u, const dvec3& v, const dvec3& w) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    to.add_product(sign * w[i], u[j], v[k]);
    to.add_product(-sign * w[i], u[k], v[j]);
  }
}

int exact_side(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  Expansion sum;
  if (exact_difference(b, a) && exact_difference(c, a) && exact_difference(d, a)) {
    add_determinant(sum, 1.0, b - a, c - a, d - a);
  } else {
    add_determinant(sum, 1.0, b, c, d);
    add_determinant(sum, -1.0, a, c, d);
    add_determinant(sum, 1.0, a, b, d);
    add_determinant(sum, -1.0, a, b, c);
  }
  return sum.sign();
}

}  // namespace

int side(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  const dvec3 u = b - a, v = c - a, w = d - a;
  double sum = 0.0, size = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double left = u[j] * v[k], right = u[k] * v[j];
    sum += w[i] * (left - right);
    size += std::abs(w[i]) * (std::abs(left) + std::abs(right));
  }
  if (std::abs(sum) > side_error * size) return sign(sum);
  return size == 0.0 ? 0 : exact_side(a, b, c, d);
}

int sure_turn(const dvec3& a, const dvec3& b, const dvec3& c, Projection on) {
  const auto [x, y] = on;
  const double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]);
  const double area = left - right;
  return std::abs(area) > turn_error * (std::abs(left) + std::abs(right)) ? sign(area) : 0;
}

int turn(const dvec3& a, const dvec3& b, const dvec3& c, Projection on) {
  if (const int sure = sure_turn(a, b, c, on); sure != 0) return sure;
  const auto [x, y] = on;
  Expansion sum;
  for (const auto& [p, q] : {std::array{&a, &b}, {&b, &c}, {&c, &a}}) {
    sum.add_product((*p)[x], (*q)[y]);
    sum.add_product(-(*p)[y], (*q)[x]);
  }
  return sum.sign();
}

}  // namespace clothlab::model
