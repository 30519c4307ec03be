// The parts of a glTF 2.0 file that hold numbers: its JSON, its buffers, and accessors as arrays. Nothing in
// a file is believed: every place is checked before it is read. Internal to server/mesh.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/mesh/mesh.h"

namespace clothlab::mesh {

inline constexpr std::size_t absent = 0xffffffffffffffffu;  ///< a number or an index that is not there

class GltfData {
 public:
  GltfData(const std::string& name, const Limits& limits, const Beside& beside)
      : name_(name), limits_(limits), beside_(beside) {}

  /// Takes a .glb or a .gltf file apart. It is refused where it needs an extension that changes the mesh.
  Status open(std::string_view bytes);

  /// The object at this place of a list, e.g. "accessors". Error: there is none.
  Result<const nlohmann::json*> item(const char* list, std::size_t index) const;
  std::size_t count(const char* list) const;
  /// A whole number, 0 or more, that is a member of an object; `otherwise` if it is absent.
  Result<std::size_t> whole(const nlohmann::json& of, const char* key, std::size_t otherwise = absent) const;
  /// The name of a node or a mesh; empty: it has none.
  static std::string name_of(const nlohmann::json& of);
  /// The numbers of an accessor, `components` each of at most `most` elements.
  Result<std::vector<double>> numbers(std::size_t accessor, std::size_t components, std::size_t most) const;

  const nlohmann::json& document() const { return document_; }
  Error wrong(const std::string& what, const std::string& remedy) const { return {name_, what, remedy}; }

 private:
  struct Layout {
    std::size_t type = 0, components = 0, count = 0;
    bool normalized = false;
  };
  Status take_apart(std::string_view bytes);
  Status parse(std::string_view text);
  Status check_extensions() const;
  Result<std::string_view> buffer(std::size_t index) const;
  Result<std::string> fetch(const std::string& uri) const;
  /// The bytes of a view, and the distance of its elements; 0: they are packed.
  Result<std::pair<std::string_view, std::size_t>> view(std::size_t index) const;
  /// Reads elements of this layout from a view.
  Result<std::vector<double>> block(std::size_t view_index, std::size_t offset, const Layout& layout) const;
  Status replace_sparse(const nlohmann::json& sparse, const Layout& layout,
                        std::vector<double>& values) const;

  const std::string& name_;
  const Limits& limits_;
  const Beside& beside_;
  nlohmann::json document_;
  std::string_view binary_;  ///< the chunk of a .glb file
  bool has_binary_ = false;
  mutable std::map<std::size_t, std::string> buffers_;  ///< those that have been read
  mutable std::size_t buffer_bytes_ = 0;
};

}  // namespace clothlab::mesh
