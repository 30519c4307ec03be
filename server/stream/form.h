// What frames can hold of each vertex: its place in an encoding, and one of the fields or none. Frames of the
// same form are made once, for all viewers who want that form.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/stream/encoding.h"

namespace clothlab::stream {

/// A number at each vertex, sent as one byte after all vertices.
enum class Field : std::uint8_t { none, strain, speed, contact };

struct FieldFacts {
  Field field;
  const char* name;  ///< as stream.subscribe spells it
  const char* unit;  ///< empty: a share or a count
  /// The least range [unit]. What is so small is noise of a cloth at rest, and must not fill the range.
  float least_range;
  const char* define;  ///< the define that field.comp is compiled with
};

/// In the order of `Field`, after `none`.
inline constexpr std::array fields{
    FieldFacts{Field::strain, "strain", "", 0.0005f, "FIELD_STRAIN"},
    FieldFacts{Field::speed, "speed", "m/s", 0.01f, "FIELD_SPEED"},
    // In contact or not: how many contacts a vertex has depends on the method and on the mesh.
    FieldFacts{Field::contact, "contact", "", 1.0f, "FIELD_CONTACT"},
};
inline constexpr const char* no_field = "none";  ///< as stream.subscribe spells Field::none

/// Where a field stands in `fields`, and in arrays beside them; not to be called with Field::none.
constexpr std::size_t index_of(Field field) {
  return static_cast<std::size_t>(field) - 1;
}
static_assert(
    [] {
      for (std::size_t i = 0; i < fields.size(); ++i)
        if (index_of(fields[i].field) != i) return false;
      return true;
    }(),
    "the rows are in the order of Field");

constexpr std::optional<Field> field_of(std::string_view name) {
  for (const FieldFacts& each : fields)
    if (each.name == name) return each.field;
  return name == no_field ? std::optional(Field::none) : std::nullopt;
}

struct Form {
  Encoding encoding;
  Field field;

  constexpr Form(Encoding of_places, Field with = Field::none) : encoding(of_places), field(with) {}
  constexpr bool operator==(const Form&) const = default;

  /// Where this form stands among all `form_count`; those without a field come first.
  constexpr std::size_t index() const {
    return static_cast<std::size_t>(field) * encoding_count + static_cast<std::size_t>(encoding);
  }
  static constexpr Form at(std::size_t index) {
    return {static_cast<Encoding>(index % encoding_count), static_cast<Field>(index / encoding_count)};
  }
  /// As the GPU packs it.
  constexpr std::size_t bytes_per_vertex() const {
    return facts(encoding).bytes_per_vertex + (field == Field::none ? 0 : 1);
  }
};
inline constexpr std::size_t form_count = encoding_count * (fields.size() + 1);

}  // namespace clothlab::stream
