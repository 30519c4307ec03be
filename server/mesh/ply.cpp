// PLY files, as text or binary of either byte order (Turk 1994): the elements `vertex` and `face`, and
// `tristrips` if that is mended; others are skipped. Texture coordinates are those of the vertices (s t, u v,
// texture_u texture_v) or of the faces' corners (a list `texcoord`).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "server/mesh/raw.h"
#include "server/mesh/text.h"

namespace clothlab::mesh {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
struct TypeName {
  std::string_view name, other_name;
  Type type;
  std::size_t bytes;
};
constexpr std::array types{
    TypeName{"char", "int8", Type::int8, 1},        TypeName{"uchar", "uint8", Type::uint8, 1},
    TypeName{"short", "int16", Type::int16, 2},     TypeName{"ushort", "uint16", Type::uint16, 2},
    TypeName{"int", "int32", Type::int32, 4},       TypeName{"uint", "uint32", Type::uint32, 4},
    TypeName{"float", "float32", Type::float32, 4}, TypeName{"double", "float64", Type::float64, 8}};

const TypeName* type_of(std::string_view word) {
  const auto found = std::find_if(types.begin(), types.end(), [&](const TypeName& type) {
    return word == type.name || word == type.other_name;
  });
  return found == types.end() ? nullptr : &*found;
}

struct Property {
  std::string name;
  const TypeName* type = nullptr;
  const TypeName* count = nullptr;  ///< of a list; null: it is no list
};
struct Element {
  std::string name;
  std::size_t count = 0, line = 0;
  std::vector<Property> properties;

  const Property* find(std::initializer_list<std::string_view> names) const {
    for (const Property& property : properties)
      if (std::find(names.begin(), names.end(), property.name) != names.end()) return &property;
    return nullptr;
  }
};
enum class Format { text, little, big };

template <class T>
double swapped(const char* from, bool swap) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return static_cast<double>(value);
}

double value_of(Type type, const char* from, bool swap) {
  switch (type) {
    case Type::int8:
      return swapped<std::int8_t>(from, swap);
    case Type::uint8:
      return swapped<std::uint8_t>(from, swap);
    case Type::int16:
      return swapped<std::int16_t>(from, swap);
    case Type::uint16:
      return swapped<std::uint16_t>(from, swap);
    case Type::int32:
      return swapped<std::int32_t>(from, swap);
    case Type::uint32:
      return swapped<std::uint32_t>(from, swap);
    case Type::float32:
      return swapped<float>(from, swap);
    case Type::float64:
      return swapped<double>(from, swap);
  }
  return 0;
}

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name, const Limits& limits, bool mend)
      : bytes_(bytes), limits_(limits), lines_(bytes) {
    raw_.name = name;
    raw_.mend = mend;
  }

  Result<Raw> read() {
    if (const Status head = read_header(); !head) return head.error();
    rest_ = bytes_.substr(lines_.end());
    if (format_ != Format::text) raw_.line_word = "face";
    for (const Element& element : elements_)
      if (const Status read = read_element(element); !read) return read.error();
    return std::move(raw_);
  }

 private:
  Error in_header(std::string what, std::string remedy) const {
    return Error{raw_.name + ", line " + std::to_string(lines_.number()), std::move(what), std::move(remedy)};
  }

  Status read_header() {
    if (!lines_.next() || lines_.line() != "ply")
      return in_header(quoted(lines_.line()), "the word ply alone in the first line of a .ply file");
    bool format = false;
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      if (first_binary_byte(rest) != std::string_view::npos)
        return in_header("a byte that no text has", "the header of a .ply file, up to end_header");
      const std::string_view keyword = next_word(rest);
      Status read = ok();
      if (keyword == "end_header") return check_header(format);
      if (keyword == "format") {
        read = read_format(rest);
        format = true;
      } else if (keyword == "element") {
        read = read_element_line(rest);
      } else if (keyword == "property") {
        read = read_property(rest);
      } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        read = in_header(quoted(keyword), "format, element, property, comment, obj_info or end_header");
      }
      if (!read) return read.error();
    }
    return in_header("the end of the file", "end_header, and the mesh");
  }

  Status read_format(std::string_view rest) {
    const std::string_view word = next_word(rest);
    if (word == "ascii")
      format_ = Format::text;
    else if (word == "binary_little_endian")
      format_ = Format::little;
    else if (word == "binary_big_endian")
      format_ = Format::big;
    else
      return in_header(quoted(word) + " as a format", "ascii, binary_little_endian or binary_big_endian");
    return ok();
  }

  Status read_element_line(std::string_view rest) {
    constexpr std::size_t most_elements = 64;
    Element element{std::string(next_word(rest)), 0, lines_.number(), {}};
    const std::string_view word = next_word(rest);
    const std::optional<std::int64_t> count = integer_in(word);
    if (!count || *count < 0) return in_header(quoted(word) + " as a count", "a whole number, 0 or more");
    if (elements_.size() == most_elements) return in_header("65 kinds of elements", "at most 64");
    element.count = static_cast<std::size_t>(*count);
    elements_.push_back(std::move(element));
    return ok();
  }

  Status read_property(std::string_view rest) {
    constexpr std::size_t most_properties = 256;
    if (elements_.empty()) return in_header("a property before any element", "an element first");
    Property property;
    std::string_view word = next_word(rest);
    if (word == "list") {
      word = next_word(rest);
      property.count = type_of(word);
      if (!property.count || property.count->type >= Type::float32)
        return in_header(quoted(word) + " as the type of a list's length", "a type of whole numbers: uchar");
      word = next_word(rest);
    }
    property.type = type_of(word);
    if (!property.type)
      return in_header(quoted(word) + " as a type", "char, uchar, short, ushort, int, uint, float or double");
    property.name = next_word(rest);
    if (elements_.back().properties.size() == most_properties)
      return in_header("257 properties of an element", "at most 256");
    elements_.back().properties.push_back(std::move(property));
    return ok();
  }

  Status check_header(bool format) const {
    if (!format) return in_header("end_header without a format", "a line such as: format ascii 1.0");
    const auto named = [&](const char* name) {
      return std::find_if(elements_.begin(), elements_.end(),
                          [&](const Element& element) { return element.name == name; });
    };
    const auto vertex = named("vertex"), strips = named("tristrips");
    auto face = named("face");
    if (face == elements_.end() && raw_.mend) face = strips;
    if (vertex == elements_.end() || face == elements_.end() || face < vertex)
      return in_header("end_header", "an element vertex, then an element face, above it");
    for (const char* axis : {"x", "y", "z"})
      if (const Property* found = vertex->find({axis}); !found || found->count)
        return in_header("an element vertex without " + std::string(axis), "x, y and z of each vertex");
    if (const Property* found = face->find({"vertex_indices", "vertex_index"}); !found || !found->count)
      return in_header("an element " + element_word(*face) + " without vertex_indices",
                       "property list uchar int vertex_indices");
    const auto over = [&](const Element& element, std::size_t most) {
      return Error{raw_.name + ", line " + std::to_string(element.line),
                   std::to_string(element.count) + " of " + quoted(element.name),
                   "at most " + std::to_string(most)};
    };
    if (vertex->count > limits_.vertices) return over(*vertex, limits_.vertices);
    if (face->count > limits_.triangles) return over(*face, limits_.triangles);
    const std::size_t left = bytes_.size() - lines_.end();
    for (const Element& element : elements_) {
      if (element.properties.empty() && element.count > 0)
        return Error{raw_.name + ", line " + std::to_string(element.line), "an element without properties",
                     "at least one property of each element"};
      std::size_t least = 0;  // bytes that one element takes
      for (const Property& property : element.properties)
        least += format_ == Format::text ? 2 : (property.count ? property.count : property.type)->bytes;
      if (least > 0 && element.count > (left + 1) / least)
        return Error{raw_.name + ", line " + std::to_string(element.line),
                     std::to_string(element.count) + " of " + quoted(element.name) + ", and " +
                         std::to_string(left) + " bytes after the header",
                     "as many as the file holds: is it whole?"};
    }
    return ok();
  }

  Error wrong(std::string what, std::string remedy) const {
    return Error{raw_.name + ", " + at_, std::move(what), std::move(remedy)};
  }

  /// The next value of an element: the next word of its line, or the next bytes.
  Result<double> value(const TypeName& type) {
    if (format_ == Format::text) {
      const std::string_view word = next_word(words_);
      const std::optional<double> number = number_in(word);
      if (!number)
        return wrong(word.empty() ? "too few numbers" : quoted(word), "a number of each property of it");
      unit_ = unit_of(word);
      return *number;
    }
    if (rest_.size() < type.bytes)
      return wrong("the end of the file", "the whole element: is the file whole?");
    const bool swap = (format_ == Format::little) != (std::endian::native == std::endian::little);
    const double number = value_of(type.type, rest_.data(), swap);
    rest_.remove_prefix(type.bytes);
    return number;
  }

  Status list(const Property& property, std::size_t most, std::vector<double>& values) {
    values.clear();
    const Result<double> count = value(*property.count);
    if (!count) return count.error();
    if (!(*count >= 0 && *count <= static_cast<double>(most)) || *count != std::floor(*count))
      return wrong("a list of " + std::to_string(*count) + " values", "0 to " + std::to_string(most));
    for (auto left = static_cast<std::size_t>(*count); left > 0; --left) {
      const Result<double> next = value(*property.type);
      if (!next) return next.error();
      values.push_back(*next);
    }
    return ok();
  }

  /// Its name without quotation marks, if that is text.
  static std::string element_word(const Element& element) {
    const std::string name = quoted(element.name);
    return name.substr(1, name.size() - 2);
  }

  /// Goes to the line of the next element.
  Status begin(const Element& element, std::size_t index) {
    number_ = index + 1;
    if (format_ != Format::text) {
      at_ = element_word(element) + " " + std::to_string(number_);
      return ok();
    }
    do {
      if (!lines_.next()) {
        at_ = "line " + std::to_string(lines_.number());
        return wrong("the end of the file after " + std::to_string(index) + " of " + quoted(element.name),
                     "all " + std::to_string(element.count) + ": is the file whole?");
      }
      words_ = lines_.line();
    } while (words_.find_first_not_of(" \t") == std::string_view::npos);
    number_ = lines_.number();
    at_ = "line " + std::to_string(number_);
    return ok();
  }

  Status read_element(const Element& element) {
    const bool vertex = element.name == "vertex", face = element.name == "face";
    std::vector<const Property*> wanted;  // of a vertex: x, y, z, u, v
    if (vertex)
      wanted = {element.find({"x"}), element.find({"y"}), element.find({"z"}),
                element.find({"s", "u", "texture_u"}), element.find({"t", "v", "texture_v"})};
    const bool strip = element.name == "tristrips" && raw_.mend;
    const Property* indices = face || strip ? element.find({"vertex_indices", "vertex_index"}) : nullptr;
    const Property* texture = face ? element.find({"texcoord"}) : nullptr;
    if (vertex) per_vertex_ = wanted[3] && wanted[4] && !wanted[3]->count && !wanted[4]->count;
    std::vector<double> numbers, corners, corner_texture, skipped;
    for (std::size_t i = 0; i < element.count; ++i) {
      if (const Status begun = begin(element, i); !begun) return begun.error();
      numbers.assign(5, 0.0);
      corners.clear();
      corner_texture.clear();
      for (const Property& property : element.properties) {
        if (property.count) {
          std::vector<double>& into = &property == indices   ? corners
                                      : &property == texture ? corner_texture
                                                             : skipped;
          const std::size_t most = strip                  ? 4 * limits_.triangles
                                   : &property == indices ? max_corners
                                                          : 2 * max_corners;
          if (const Status read = list(property, most, into); !read) return read.error();
          continue;
        }
        const Result<double> number = value(*property.type);
        if (!number) return number.error();
        const auto slot = std::find(wanted.begin(), wanted.end(), &property);
        if (slot == wanted.end()) continue;
        const auto at = static_cast<std::size_t>(slot - wanted.begin());
        numbers[at] = *number;
        if (at < 3 && format_ == Format::text) raw_.unit = std::min(raw_.unit, unit_);
      }
      if (format_ == Format::text)
        if (const std::string_view more = next_word(words_); !more.empty())
          return wrong(quoted(more) + " after the last property", "the end of the line");
      Status added = ok();
      if (vertex) added = add_vertex(numbers);
      if (face) added = add_face(corners, corner_texture);
      if (strip) added = add_strip(corners);
      if (!added) return added.error();
    }
    return ok();
  }

  Status add_vertex(const std::vector<double>& numbers) {
    if (per_vertex_) raw_.texture.emplace_back(numbers[3], numbers[4]);
    for (std::size_t i = 0; i < (per_vertex_ ? 5 : 3); ++i)
      if (!(std::abs(numbers[i]) <= largest_coordinate))  // true for NaN
        return raw_.add_placeless(
            wrong(std::to_string(numbers[i]) + " as a coordinate", "a number from -1e+06 to 1e+06"), number_,
            limits_);
    return raw_.add_vertex({numbers[0], numbers[1], numbers[2]}, number_, limits_);
  }

  /// Each corner from the third on makes a triangle with the two before it, every second one turned over; a
  /// negative number ends a strip.
  Status add_strip(const std::vector<double>& corners) {
    raw_.mended.add(Fault::strip, at_);
    std::size_t first = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (corners[i] < 0) first = i + 1;
      if (i < first + 2 || corners[i] < 0) continue;
      const bool turned = (i - first) % 2 == 1;
      const double a = corners[i - (turned ? 1 : 2)], b = corners[i - (turned ? 2 : 1)], c = corners[i];
      if (a == b || b == c || c == a) continue;  // joins two strips
      if (const Status added = add_face({a, b, c}, {}); !added) return added.error();
    }
    return ok();
  }

  Status add_face(const std::vector<double>& corners, const std::vector<double>& texture) {
    face_.clear();
    for (const double corner : corners) {
      if (!(corner >= 0 && corner < static_cast<double>(raw_.vertices.size())) ||
          corner != std::floor(corner))
        return raw_.leave_out(
            Fault::face, number_,
            wrong(std::to_string(corner) + " as a vertex",
                  raw_.vertices.empty() ? "no face, as there is no vertex"
                                        : "0 to " + std::to_string(raw_.vertices.size() - 1)));
      face_.push_back({static_cast<std::uint32_t>(corner),
                       per_vertex_ ? static_cast<std::uint32_t>(corner) : no_texture});
    }
    if (!per_vertex_ && texture.size() == 2 * corners.size()) {
      for (std::size_t i = 0; i < face_.size(); ++i) {
        const glm::dvec2 place(texture[2 * i], texture[2 * i + 1]);
        if (!(std::abs(place.x) <= largest_coordinate && std::abs(place.y) <= largest_coordinate))
          return raw_.leave_out(
              Fault::face, number_,
              wrong("a texture coordinate that is no number", "numbers from -1e+06 to 1e+06"));
        face_[i].texture = static_cast<std::uint32_t>(raw_.texture.size());
        raw_.texture.push_back(place);
      }
    }
    return raw_.add_face(face_, number_, limits_);
  }

  std::string_view bytes_;
  const Limits& limits_;
  Lines lines_;
  Raw raw_;
  Format format_ = Format::text;
  double unit_ = 0;  ///< of the last value of a text (unit_of)
  std::vector<Element> elements_;
  std::string_view rest_;   ///< of a binary file: what is still to be read
  std::string_view words_;  ///< of a text: what is still to be read of this line
  std::size_t number_ = 0;  ///< of this line, or of this element of a binary file, from 1
  std::string at_;          ///< the same in words
  bool per_vertex_ = false;
  std::vector<Corner> face_;
};

}  // namespace

Result<Raw> read_ply(std::string_view bytes, const std::string& name, const Limits& limits,
                     const Reading& reading) {
  if (!reading.node.empty()) return no_part(name, reading.node, {});
  return PlyReader(bytes, name, limits, reading.mend).read();
}

}  // namespace clothlab::mesh
