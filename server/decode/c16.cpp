#include "server/decode/c16.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "server/base/deflate.h"

namespace clothlab::decode {

namespace {

/// For each vertex the triples a, b, c whose a + b - c are averaged.
using Parallelograms = std::vector<std::vector<std::array<std::uint32_t, 3>>>;

Parallelograms parallelograms(std::uint32_t vertex_count, Triangles triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> thirds;  // of each edge
  for (const auto& [a, b, c] : triangles)
    for (const auto& [from, to, third] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}})
      if (from != to) thirds[std::minmax(from, to)].push_back(third);
  std::array<Parallelograms, 3> rules;
  for (Parallelograms& rule : rules) rule.resize(vertex_count);
  for (const auto& [edge, corners] : thirds) {
    const auto [low, high] = edge;
    if (corners.size() == 2) {
      const auto [near, far] = std::minmax(corners[0], corners[1]);
      if (far < high) rules[0][high].push_back({near, far, low});
      if (high < far && near < far) rules[1][far].push_back({low, high, near});
    }
    rules[2][high].push_back({low, low, low});
  }
  Parallelograms chosen(vertex_count);
  for (std::uint32_t i = 0; i < vertex_count; ++i) {
    for (std::size_t rule = 0; chosen[i].empty() && rule < rules.size(); ++rule) chosen[i] = rules[rule][i];
    if (chosen[i].empty() && i > 0) chosen[i].push_back({i - 1, i - 1, i - 1});
  }
  return chosen;
}

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The numbers of a frame in their order. For each one `number(place, prediction, near)` is called: it
/// returns the number, having set the `place` if that is not known yet. Ends early, with false, after a
/// negative one.
template <class Number>
bool each_number(Compressed& frame, const FrameHeader& header, Triangles triangles, const Number& number) {
  const std::size_t count = frame.vertices.size();
  const Parallelograms all = parallelograms(header.vertex_count, triangles);
  std::vector<std::array<std::int64_t, 3>> numbers(count);
  std::vector<std::array<double, 2>> stretch(count);
  const auto vector = [&](std::size_t from, const auto& to) {
    Vector v;
    for (std::size_t axis = 0; axis < 3; ++axis)
      v[axis] = static_cast<double>(to[axis] - frame.vertices[from][axis]) *
                static_cast<double>(header.box_extent[axis]);
    return v;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const auto& triples = all[i];
    std::array<int, 3> p{};
    for (std::size_t axis = 0; axis < 3 && !triples.empty(); ++axis) {
      double sum = 0;
      for (const auto& [a, b, c] : triples)
        sum += frame.vertices[a][axis] + frame.vertices[b][axis] - frame.vertices[c][axis];
      p[axis] = static_cast<int>(std::floor(sum / static_cast<double>(triples.size())));
    }
    bool valid = true;
    std::size_t turn = 0;
    const auto next = [&](std::size_t axis, int prediction) {
      std::int64_t near = 0;
      if (!triples.empty())
        for (const std::uint32_t vertex : triples[0]) near += numbers[vertex][turn];
      const std::int64_t made = valid ? number(frame.vertices[i][axis], prediction, near) : -1;
      valid = made >= 0;
      numbers[i][turn++] = made;
      return static_cast<double>(made % 2 == 0 ? made / 2 : -(made + 1) / 2);
    };
    const auto [a, b, c] = triples.empty() ? std::array<std::uint32_t, 3>{} : triples[0];
    if (a == c) {
      for (std::size_t axis = 0; axis < 3; ++axis) next(axis, p[axis]);
      if (!valid) return false;
      continue;
    }
    const Vector P = vector(a, p), Q = vector(b, p);
    const Vector N{P[1] * Q[2] - P[2] * Q[1], P[2] * Q[0] - P[0] * Q[2], P[0] * Q[1] - P[1] * Q[0]};
    std::size_t k = 0;
    if (std::fabs(N[1]) > std::fabs(N[k])) k = 1;
    if (std::fabs(N[2]) > std::fabs(N[k])) k = 2;
    const double s = next(k, p[k]) * static_cast<double>(header.box_extent[k]) / N[k];
    const double off = s * s * dot(N, N);
    const double g = (0.75 * stretch[a][0] - off) / 2, h = (0.75 * stretch[b][1] - off) / 2;
    const double alpha = (g * dot(Q, Q) - h * dot(P, Q)) / dot(N, N),
                 beta = (h * dot(P, P) - g * dot(P, Q)) / dot(N, N);
    Vector T;
    for (std::size_t axis = 0; axis < 3; ++axis) T[axis] = alpha * P[axis] + beta * Q[axis];
    const double t = s - T[k] / N[k];
    for (const std::size_t axis : {(k + 1) % 3, (k + 2) % 3}) {
      const double more = (t * N[axis] + T[axis]) / static_cast<double>(header.box_extent[axis]);
      next(axis, p[axis] + (std::fabs(more) < 32768.0 ? static_cast<int>(std::floor(more + 0.5)) : 0));
    }
    if (!valid) return false;
    const Vector to_a = vector(a, frame.vertices[i]), to_b = vector(b, frame.vertices[i]);
    stretch[i] = {dot(to_a, to_a) - dot(P, P), dot(to_b, to_b) - dot(Q, Q)};
  }
  return true;
}

/// How many low bits a number has, of which three neighbours' sum is this.
int low_bits(std::int64_t near) {
  int bits = 0;
  while (near / 4 >= std::int64_t{1} << bits) ++bits;
  return bits;
}

}  // namespace

Result<Decoded> read_compressed(std::span<const std::uint8_t> bytes, const FrameHeader& header,
                                Triangles triangles) {
  const std::size_t count = header.vertex_count, field_bytes = header.range > 0.0f ? count : 0;
  for (const auto& triangle : triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= count) return refused(12, std::to_string(count) + " vertices", "those of the topology");
  const auto content = inflate_raw(bytes.subspan(header_bytes), field_bytes + (3 * 28 * count + 7) / 8);
  if (!content) return refused(header_bytes, content.error().what, content.error().remedy);
  const auto wrong = [] { return refused(header_bytes, "more or fewer numbers", "three for each vertex"); };
  if (content->size() < field_bytes + (3 * count + 7) / 8) return wrong();  // before memory is taken for them
  const std::vector<std::uint8_t> field(content->begin(), content->begin() + static_cast<long>(field_bytes));
  std::size_t at = 8 * field_bytes;
  const auto bit = [&]() -> std::int64_t {
    const std::size_t byte = at / 8, place = 7 - at % 8;
    ++at;
    return byte < content->size() ? (*content)[byte] >> place & 1 : 0;
  };
  Compressed frame;
  frame.vertices.resize(count);
  const bool valid = each_number(
      frame, header, triangles, [&](std::uint16_t& place, int prediction, std::int64_t near) -> std::int64_t {
        std::int64_t number = 0;
        while (number < 12 && bit() == 1) ++number;
        const bool whole = number == 12;
        if (whole) number = 0;
        for (int left = whole ? 16 : low_bits(near); left > 0; --left) number = 2 * number + bit();
        if (number > 65535 || at > 8 * content->size()) return -1;
        const std::int64_t difference = number % 2 == 0 ? number / 2 : -(number + 1) / 2;
        place = static_cast<std::uint16_t>((prediction + difference) & 0xffff);
        return number;
      });
  if (!valid || (at + 7) / 8 != content->size()) return wrong();
  while (at % 8 != 0)
    if (bit() == 1) return wrong();
  return Decoded{header, std::move(frame), field};
}

void put_compressed(std::vector<std::uint8_t>& out, const FrameHeader& header, Compressed frame,
                    Triangles triangles) {
  std::size_t at = 8 * out.size();
  const auto put = [&](std::int64_t number, int bits) {
    for (int left = bits - 1; left >= 0; --left, ++at) {
      if (at % 8 == 0) out.push_back(0);
      if ((number >> left & 1) == 1) out.back() |= static_cast<std::uint8_t>(128 >> at % 8);
    }
  };
  each_number(frame, header, triangles, [&](std::uint16_t place, int prediction, std::int64_t near) {
    int difference = (place - prediction) & 0xffff;
    if (difference > 0x7fff) difference -= 0x10000;
    const std::int64_t number = difference < 0 ? -2 * difference - 1 : 2 * difference;
    const int low = low_bits(near);
    const std::int64_t ones = std::min<std::int64_t>(number >> low, 12);
    for (std::int64_t k = 0; k < ones; ++k) put(1, 1);
    if (ones < 12) put(0, 1);
    put(number, ones < 12 ? low : 16);
    return number;
  });
}

}  // namespace clothlab::decode
