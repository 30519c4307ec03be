// OBJ files: the `v`, `vt` and `f` lines of Wavefront's format, of all of it or of one object or group (`o`,
// `g`). Normals and materials are left aside; of curved surfaces and other words a cloth or a body is made
// without them, or they are refused.
#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/mesh/raw.h"
#include "server/mesh/text.h"

namespace clothlab::mesh {

namespace {

/// Keywords without a meaning for cloth.
constexpr std::string_view ignored[] = {"vn",       "vp",       "s",          "mg",       "l",     "p",
                                        "usemtl",   "mtllib",   "usemap",     "maplib",   "bevel", "lod",
                                        "c_interp", "d_interp", "shadow_obj", "trace_obj"};
constexpr std::string_view curved[] = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                       "parm",   "trim", "hole", "scrv", "sp",   "end",   "con"};

template <std::size_t count>
bool contains(const std::string_view (&words)[count], std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class ObjReader {
 public:
  ObjReader(const std::string& name, const Limits& limits, const Reading& reading)
      : limits_(limits), node_(reading.node), wanted_(reading.node.empty()) {
    raw_.name = name;
    raw_.mend = reading.mend;
  }

  Result<Raw> read(std::string_view text) {
    Lines lines(text);
    std::string joined;
    while (lines.next()) {
      line_ = lines.number();
      std::string_view line = lines.line();
      if (!line.empty() && line.back() == '\\') {  // goes on in the next line
        joined.clear();
        while (!line.empty() && line.back() == '\\') {
          joined.append(line.substr(0, line.size() - 1)).append(" ");
          line = lines.next() ? lines.line() : std::string_view();
        }
        line = joined.append(line);
      }
      if (const Status read = read_line(line); !read) return read.error();
    }
    if (!node_.empty() && !found_) return no_part(raw_.name, node_, raw_.parts);
    return std::move(raw_);
  }

 private:
  Error wrong(std::string what, std::string remedy) const {
    return raw_.error(line_, std::move(what), std::move(remedy));
  }

  Status read_line(std::string_view line) {
    if (const std::size_t at = first_binary_byte(line); at != std::string_view::npos)
      return wrong(formatted("the byte 0x%02x, which no text has", static_cast<unsigned char>(line[at])),
                   "an .obj file is text; a binary mesh may be a .ply file");
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = next_word(line);
    if (keyword.empty() || contains(ignored, keyword)) return ok();
    if (keyword == "v") return read_vertex(line);
    if (keyword == "vt") return read_texture(line);
    if (keyword == "f") return read_face(line);
    if (keyword == "o" || keyword == "g") return read_part(keyword == "o", line), ok();
    if (contains(curved, keyword))
      return raw_.leave_out(
          Fault::curve, line_,
          wrong(quoted(keyword) + ", of a curved surface", "polygons alone: convert it to a mesh"));
    if (!raw_.mend)
      return wrong(quoted(keyword), "a line of an .obj file: v, vt, vn, f, o, g, s, usemtl, mtllib, #");
    raw_.mended.add(Fault::word, quoted(keyword) + " in line " + std::to_string(line_));
    return ok();
  }

  /// The faces that follow are of this object, or of these groups.
  void read_part(bool object, std::string_view rest) {
    bool& in = object ? in_object_ : in_group_;
    in = false;
    if (object) {  // its name may have blanks in it
      const std::size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
      const std::size_t last = rest.find_last_not_of(" \t");
      name_part(rest.substr(first, last == std::string_view::npos ? 0 : last + 1 - first), in);
      in_group_ = false;
    } else {
      const std::size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
      const std::size_t last = rest.find_last_not_of(" \t");
      if (last != std::string_view::npos && rest.substr(first, last + 1 - first) == node_)
        name_part(node_, in);
      else
        for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
          name_part(word, in);
    }
    wanted_ = node_.empty() || in_object_ || in_group_;
  }

  void name_part(std::string_view name, bool& in) {
    if (name.empty()) return;
    raw_.name_part(std::string(name));
    if (name != node_) return;
    in = found_ = true;
  }

  /// One finite number in range. `what` names it in the error.
  Status number(std::string_view word, const char* what, double& value) const {
    const std::optional<double> read = number_in(word);
    if (read && std::abs(*read) <= largest_coordinate) {  // false for NaN
      value = *read;
      return ok();
    }
    return wrong(word.empty() ? std::string("nothing") + " as " + what : quoted(word) + " as " + what,
                 "a number from -1e+06 to 1e+06");
  }

  /// At least one number besides those wanted may follow: a weight, a color, a third texture coordinate.
  Status no_more_than(std::string_view rest, int most) const {
    double ignored_value = 0;
    for (int i = 0; i < most; ++i) {
      const std::string_view word = next_word(rest);
      if (word.empty()) return ok();
      if (const Status read = number(word, "a further number", ignored_value); !read) return read.error();
    }
    const std::string_view word = next_word(rest);
    return word.empty() ? ok()
                        : Status(wrong(quoted(word) + " after the last number", "the end of the line"));
  }

  Status read_vertex(std::string_view rest) {
    const Result<glm::dvec3> place = place_in(rest);
    return place ? raw_.add_vertex(*place, line_, limits_)
                 : raw_.add_placeless(place.error(), line_, limits_);
  }

  Result<glm::dvec3> place_in(std::string_view rest) {
    glm::dvec3 place(0.0);
    constexpr const char* names[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = next_word(rest);
      if (const Status read = number(word, names[axis], place[axis]); !read) return read.error();
      raw_.unit = std::min(raw_.unit, unit_of(word));
    }
    if (const Status rest_read = no_more_than(rest, 4); !rest_read) return rest_read.error();
    return place;
  }

  Result<glm::dvec2> texture_in(std::string_view rest) const {
    glm::dvec2 place(0.0);
    if (const Status read = number(next_word(rest), "u", place.x); !read) return read.error();
    std::string_view word = next_word(rest);
    if (!word.empty())
      if (const Status read = number(word, "v", place.y); !read) return read.error();
    if (const Status rest_read = no_more_than(rest, 1); !rest_read) return rest_read.error();
    return place;
  }

  Status read_texture(std::string_view rest) {
    const Result<glm::dvec2> place = texture_in(rest);
    if (!place)
      if (const Status left = raw_.leave_out(Fault::texture, line_, place.error()); !left)
        return left.error();
    if (raw_.texture.size() >= 3 * limits_.triangles)
      return wrong("more than " + std::to_string(3 * limits_.triangles) + " texture coordinates",
                   "at most so many");
    raw_.texture.push_back(place ? *place : glm::dvec2(0.0));
    return ok();
  }

  /// The index that a word gives: from 1, or from -1 backwards. `count` of them are in the file so far.
  Result<std::uint32_t> index(std::string_view word, const char* kind, std::size_t count) const {
    const std::optional<std::int64_t> read = integer_in(word);
    const auto most = static_cast<std::int64_t>(count);
    if (read && *read >= 1 && *read <= most) return static_cast<std::uint32_t>(*read - 1);
    if (read && *read <= -1 && *read >= -most) return static_cast<std::uint32_t>(most + *read);
    return wrong(quoted(word) + " as a " + kind,
                 most == 0 ? std::string("a number of a ") + kind + " above this line; there is none"
                           : "1 to " + std::to_string(most) + ", the last above this line, or -1 to -" +
                                 std::to_string(most));
  }

  /// "7", "7/2", "7//3" or "7/2/3": vertex, texture coordinates, normal.
  Result<Corner> corner(std::string_view word) const {
    const std::size_t slash = word.find('/');
    const Result<std::uint32_t> vertex = index(word.substr(0, slash), "vertex", raw_.vertices.size());
    if (!vertex) return vertex.error();
    Corner corner{*vertex};
    if (slash == std::string_view::npos) return corner;
    std::string_view texture = word.substr(slash + 1);
    const std::size_t second = texture.find('/');
    const std::string_view normal =
        second == std::string_view::npos ? std::string_view() : texture.substr(second + 1);
    texture = texture.substr(0, second);
    if (!normal.empty() && !integer_in(normal))
      return wrong(quoted(word) + " as a corner", "VERTEX, VERTEX/TEXTURE or VERTEX/TEXTURE/NORMAL");
    if (texture.empty()) return corner;
    const Result<std::uint32_t> at = index(texture, "texture coordinate", raw_.texture.size());
    if (!at) return at.error();
    corner.texture = *at;
    return corner;
  }

  Status read_face(std::string_view rest) {
    if (!wanted_) return ok();
    corners_.clear();
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const Result<Corner> read = corner(word);
      if (!read) return raw_.leave_out(Fault::face, line_, read.error());
      corners_.push_back(*read);
      if (corners_.size() > max_corners) break;  // add_face refuses it
    }
    return raw_.add_face(corners_, line_, limits_);
  }

  const Limits& limits_;
  const std::string node_;
  bool wanted_;  ///< the faces that follow are those of the part that is read
  bool in_object_ = false, in_group_ = false, found_ = false;
  Raw raw_;
  std::size_t line_ = 0;
  std::vector<Corner> corners_;
};

}  // namespace

Result<Raw> read_obj(std::string_view text, const std::string& name, const Limits& limits,
                     const Reading& reading) {
  return ObjReader(name, limits, reading).read(text);
}

}  // namespace clothlab::mesh
