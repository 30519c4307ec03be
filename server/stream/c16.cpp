#include "server/stream/c16.h"

#include <bit>
#include <cmath>

#include "server/stream/folded.h"

namespace clothlab::stream {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Writes numbers of some bits each, from the highest bit of a byte down.
class Bits {
 public:
  explicit Bits(std::vector<std::uint8_t>& out) : out_(out) {}
  void put(std::uint32_t number, int bits) {
    waiting_ = waiting_ << bits | number;
    for (count_ += bits; count_ >= 8; count_ -= 8)
      out_.push_back(static_cast<std::uint8_t>(waiting_ >> (count_ - 8)));
  }
  void end() {
    if (count_ > 0) put(0, 8 - count_);
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::uint64_t waiting_ = 0;
  int count_ = 0;  ///< of bits that wait
};

constexpr std::uint32_t most_ones = 12;

/// `near` is the sum of three such numbers.
void put_number(Bits& bits, std::uint32_t number, std::uint32_t near) {
  const int low = std::bit_width(near / 4);
  const std::uint32_t ones = number >> low;
  if (ones < most_ones) {
    bits.put((2u << ones) - 2, static_cast<int>(ones) + 1);
    bits.put(number & ((1u << low) - 1), low);
  } else {
    bits.put((1u << most_ones) - 1, most_ones);
    bits.put(number, 16);
  }
}

class Writer {
 public:
  Writer(std::span<const Position> positions, const std::array<float, 3>& extent, const Predictor& predictor)
      : positions_(positions),
        extent_{double{extent[0]}, double{extent[1]}, double{extent[2]}},
        predictor_(predictor),
        numbers_(positions.size()),
        stretch_(positions.size()) {}

  void put(Bits& bits) {
    for (std::uint32_t i = 0; i < positions_.size(); ++i) put(bits, i);
  }

 private:
  void put(Bits& bits, std::uint32_t i) {
    const Position& place = positions_[i];
    std::array<std::int32_t, 3> p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = predictor_.at(i, positions_.data()->data(), 3, axis);
    const Predictor::Candidate candidate = predictor_.first_candidate(i);
    const std::uint32_t a = candidate[0], b = candidate[1], c = candidate[2];
    const auto add = [&](std::size_t turn, std::size_t axis, std::int32_t prediction) {
      // Of vertex 0 this is before its own number.
      const std::uint32_t near = std::uint32_t{numbers_[a][turn]} + numbers_[b][turn] + numbers_[c][turn];
      numbers_[i][turn] = folded(place[axis], prediction);
      put_number(bits, numbers_[i][turn], near);
    };
    if (a == c) {  // no parallelogram
      for (std::size_t axis = 0; axis < 3; ++axis) add(axis, axis, p[axis]);
      return;
    }
    const Vector from_a = between(positions_[a], p), from_b = between(positions_[b], p);
    const Vector normal{from_a[1] * from_b[2] - from_a[2] * from_b[1],
                        from_a[2] * from_b[0] - from_a[0] * from_b[2],
                        from_a[0] * from_b[1] - from_a[1] * from_b[0]};
    std::size_t k = 0;
    for (const std::size_t axis : {1u, 2u})
      if (std::abs(normal[axis]) > std::abs(normal[k])) k = axis;
    add(0, k, p[k]);

    // Off the plane by s normals, the vertex comes nearer, so that both edges keep their lengths.
    const double s =
        static_cast<std::int16_t>(static_cast<std::uint16_t>(place[k] - p[k])) * extent_[k] / normal[k];
    const double aa = dot(from_a, from_a), bb = dot(from_b, from_b), ab = dot(from_a, from_b),
                 nn = dot(normal, normal), off = s * s * nn;
    const double for_a = (share_kept * stretch_[a][0] - off) / 2,
                 for_b = (share_kept * stretch_[b][1] - off) / 2;
    const double along_a = (for_a * bb - for_b * ab) / nn, along_b = (for_b * aa - for_a * ab) / nn;
    Vector nearer;
    for (std::size_t axis = 0; axis < 3; ++axis)
      nearer[axis] = along_a * from_a[axis] + along_b * from_b[axis];
    const double normals = s - nearer[k] / normal[k];
    for (const std::size_t turn : {1u, 2u}) {
      const std::size_t axis = (k + turn) % 3;
      const double more = (normals * normal[axis] + nearer[axis]) / extent_[axis];
      const bool usable = std::abs(more) < 32768;  // false for no number
      add(turn, axis, p[axis] + (usable ? static_cast<std::int32_t>(std::floor(more + 0.5)) : 0));
    }
    const Vector to_a = between(positions_[a], place), to_b = between(positions_[b], place);
    stretch_[i] = {dot(to_a, to_a) - aa, dot(to_b, to_b) - bb};
  }

  template <class Place>
  Vector between(const Position& from, const Place& to) const {
    Vector vector;
    for (std::size_t axis = 0; axis < 3; ++axis) vector[axis] = (to[axis] - from[axis]) * extent_[axis];
    return vector;
  }

  static constexpr double share_kept = 0.75;  ///< of a stretch, from one edge of a thread to the next

  std::span<const Position> positions_;
  Vector extent_;
  const Predictor& predictor_;
  std::vector<std::array<std::uint16_t, 3>> numbers_;  ///< in the order in which they are sent
  /// By how much the squares of a vertex's edges to a and b are more than predicted. A thread's strain
  /// changes little along it.
  std::vector<std::array<double, 2>> stretch_;
};

}  // namespace

void put_positions(std::vector<std::uint8_t>& out, std::span<const Position> positions,
                   const std::array<float, 3>& extent, const Predictor& predictor) {
  Bits bits(out);
  Writer(positions, extent, predictor).put(bits);
  bits.end();
}

}  // namespace clothlab::stream
