// Frames as the GPU packs them, decoded by what is written from the protocol's table alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <variant>

#include "server/decode/frame.h"
#include "server/selftest/checks.h"
#include "server/stream/compressor.h"
#include "server/stream/packer.h"

namespace clothlab::selftest {

namespace {

using glm::dvec3;
using stream::Encoding;

Result<decode::Decoded> decoded(const sim::Simulation& simulation, stream::Form form) {
  auto packer = stream::Packer::create();
  if (!packer) return packer.error();
  (*packer)->request(simulation, form, 0);
  stream::SharedMessage frame = (*packer)->wait();
  if (!frame) return Error{"frame", "none came", ""};
  const model::Model& model = simulation.model();
  if (form.encoding == Encoding::c16)
    frame = stream::compress(*frame, stream::Predictor(model.vertex_count(), model.triangles));
  return decode::decode_frame({frame->data(), frame->size()}, model.triangles);
}

/// Unit normals of the vertices: of the sums of the cross products of their triangles.
std::vector<dvec3> normals_of(const model::Model& model, const std::vector<glm::vec3>& position) {
  std::vector<dvec3> normal(position.size(), dvec3(0.0));
  for (const auto& [a, b, c] : model.triangles) {
    const dvec3 across =
        glm::cross(dvec3(position[b]) - dvec3(position[a]), dvec3(position[c]) - dvec3(position[a]));
    for (const std::uint32_t corner : {a, b, c}) normal[corner] += across;
  }
  for (dvec3& n : normal) n = glm::normalize(n);
  return normal;
}

/// The inverse of octahedral in shaders/stream/pack.comp.
dvec3 unfolded(double x, double y) {
  dvec3 n(x, y, 1.0 - std::abs(x) - std::abs(y));
  if (n.z < 0.0)
    n = {(1.0 - std::abs(y)) * (x >= 0.0 ? 1.0 : -1.0), (1.0 - std::abs(x)) * (y >= 0.0 ? 1.0 : -1.0), n.z};
  return glm::normalize(n);
}

struct Vertex {
  dvec3 place, normal;  ///< no normal: it is not sent
};
std::vector<Vertex> vertices_of(const decode::Decoded& frame) {
  std::vector<Vertex> vertices;
  const auto place = [&](const std::array<std::uint16_t, 3>& position) {
    const std::array<double, 3> at = decode::Quantised::position(frame.header, {position, {}});
    return dvec3(at[0], at[1], at[2]);
  };
  if (const auto* floats = std::get_if<decode::Float32>(&frame.payload))
    for (const auto& v : floats->vertices) vertices.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
  if (const auto* quantised = std::get_if<decode::Quantised>(&frame.payload))
    for (const auto& v : quantised->vertices)
      vertices.push_back({place(v.position), unfolded(v.normal[0] / 127.0, v.normal[1] / 127.0)});
  if (const auto* compressed = std::get_if<decode::Compressed>(&frame.payload))
    for (const auto& position : compressed->vertices) vertices.push_back({place(position), dvec3(0.0)});
  return vertices;
}

/// Half a quantum along each axis, and a float32 rounding of places of about a metre.
double allowed_place(const decode::FrameHeader& header, Encoding encoding) {
  if (encoding == Encoding::f32) return 0.0;  // the bits themselves
  double square = 0.0;
  for (const float extent : header.box_extent)
    square += std::pow(0.5 * static_cast<double>(extent) / 65535.0 + 2.4e-7, 2);
  return std::sqrt(square);
}

/// Of normals, as lengths of differences: 8 bits on the octahedron, whose faces are at most sqrt(3) steeper
/// than the sphere; in float32 the rounding of places over the least height of a triangle.
constexpr double allowed_octahedral = 1.7 * 1.42 * 0.5 / 127.0 + 1e-4, allowed_float32 = 1e-4;

Result<Check> check_encoding(const std::string& name, sim::Simulation& simulation, Encoding encoding) {
  const Result<decode::Decoded> frame = decoded(simulation, encoding);
  if (!frame) return frame.error();
  const sim::State state = simulation.read_state();
  const std::vector<dvec3> normal = normals_of(simulation.model(), state.position);
  const std::vector<Vertex> vertices = vertices_of(*frame);
  if (vertices.size() != state.position.size())
    return Error{"frame", std::to_string(vertices.size()) + " vertices", ""};
  double place = 0.0, turn = 0.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    place = std::max(place, glm::distance(vertices[i].place, dvec3(state.position[i])));
    if (encoding != Encoding::c16) turn = std::max(turn, glm::distance(vertices[i].normal, normal[i]));
  }
  const double allowed_turn = encoding == Encoding::f32 ? allowed_float32 : allowed_octahedral;
  if (turn > allowed_turn) return at_most(name, turn, allowed_turn, "", "off is a normal");
  return at_most(name, place, allowed_place(frame->header, encoding), "m",
                 "off is the farthest vertex, decoded");
}

/// The field speed: each vertex's speed as a byte of the range.
Result<Check> check_field(const std::string& name, sim::Simulation& simulation) {
  const Result<decode::Decoded> frame = decoded(simulation, {Encoding::q16, stream::Field::speed});
  if (!frame) return frame.error();
  const sim::State state = simulation.read_state();
  if (frame->field.size() != state.velocity.size())
    return Error{"frame", std::to_string(frame->field.size()) + " bytes of a field", ""};
  const auto range = static_cast<double>(frame->header.range);
  double off = 0.0;
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    off = std::max(off, std::abs(frame->field[i] / 255.0 * range - glm::length(dvec3(state.velocity[i]))));
  return at_most(name, off, range * (0.5 / 255.0 + 1e-6), "m/s", "off is a speed, decoded");
}

}  // namespace

void check_frames(Report& report, const ShortRun& run) {
  std::unique_ptr<sim::Simulation> simulation;
  const auto stepped = [&]() -> Status {
    if (simulation) return ok();
    auto made = started(run);
    if (!made) return made.error();
    simulation = std::move(*made);
    simulation->step(static_cast<std::uint32_t>(run.steps));
    return ok();
  };
  for (const stream::EncodingFacts& encoding : stream::encodings) {
    const std::string name = std::string("frames: ") + encoding.name;
    report.make(name, [&]() -> Result<Check> {
      if (Status made = stepped(); !made) return made.error();
      return check_encoding(name, *simulation, encoding.encoding);
    });
  }
  const std::string name = "frames: speed of vertices";
  report.make(name, [&]() -> Result<Check> {
    if (Status made = stepped(); !made) return made.error();
    return check_field(name, *simulation);
  });
}

}  // namespace clothlab::selftest
