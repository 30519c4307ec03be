// The accessors of a glTF file as arrays of numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "server/mesh/gltf_data.h"
#include "server/mesh/text.h"

namespace clothlab::mesh {

namespace {

using nlohmann::json;

struct Component {
  std::size_t type, bytes;
  double largest;  ///< that 1 is, of normalized ones
  double (*value)(const char*);
};
template <class Number>
double value_at(const char* from) {
  Number number;
  std::memcpy(&number, from, sizeof number);
  return static_cast<double>(number);
}
constexpr std::array<Component, 6> component_types{{{5120, 1, 127.0, value_at<std::int8_t>},
                                                    {5121, 1, 255.0, value_at<std::uint8_t>},
                                                    {5122, 2, 32767.0, value_at<std::int16_t>},
                                                    {5123, 2, 65535.0, value_at<std::uint16_t>},
                                                    {5125, 4, 4294967295.0, value_at<std::uint32_t>},
                                                    {5126, 4, 1.0, value_at<float>}}};

const Component* component_of(std::size_t type) {
  const auto found = std::find_if(component_types.begin(), component_types.end(),
                                  [&](const Component& of) { return of.type == type; });
  return found == component_types.end() ? nullptr : &*found;
}

constexpr std::array<std::pair<std::string_view, std::size_t>, 7> element_types{
    {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};

}  // namespace

Result<std::pair<std::string_view, std::size_t>> GltfData::view(std::size_t index) const {
  const Result<const json*> found = item("bufferViews", index);
  if (!found) return found.error();
  if (const auto extensions = (*found)->find("extensions");
      extensions != (*found)->end() && extensions->contains("EXT_meshopt_compression"))
    return wrong("a mesh that is compressed (EXT_meshopt_compression)",
                 "an export without compression, or what `npx @gltf-transform/cli copy` makes of the file");
  const Result<std::size_t> of = whole(**found, "buffer", 0), offset = whole(**found, "byteOffset", 0),
                            length = whole(**found, "byteLength", 0),
                            stride = whole(**found, "byteStride", 0);
  for (const auto* each : {&of, &offset, &length, &stride})
    if (!*each) return each->error();
  const Result<std::string_view> bytes = buffer(*of);
  if (!bytes) return bytes.error();
  if (*offset + *length > bytes->size())
    return wrong("bufferViews/" + std::to_string(index) + ", which goes beyond its buffer of " +
                     std::to_string(bytes->size()) + " bytes",
                 "a view within its buffer");
  return std::pair(bytes->substr(*offset, *length), *stride);
}

Result<std::vector<double>> GltfData::block(std::size_t view_index, std::size_t offset,
                                            const Layout& layout) const {
  const Result<std::pair<std::string_view, std::size_t>> found = view(view_index);
  if (!found) return found.error();
  const auto& [bytes, distance] = *found;
  const Component* component = component_of(layout.type);
  if (!component)
    return wrong(std::to_string(layout.type) + " as componentType", "5120, 5121, 5122, 5123, 5125 or 5126");
  const std::size_t element = layout.components * component->bytes,
                    stride = distance > 0 ? distance : element;
  if (stride < element || (layout.count > 0 && offset + stride * (layout.count - 1) + element > bytes.size()))
    return wrong(std::to_string(layout.count) + " elements of " + std::to_string(element) + " bytes, " +
                     std::to_string(stride) + " apart, in bufferViews/" + std::to_string(view_index) +
                     " of " + std::to_string(bytes.size()) + " bytes",
                 "as many as the view holds");
  std::vector<double> values;
  values.reserve(layout.count * layout.components);
  for (std::size_t i = 0; i < layout.count; ++i)
    for (std::size_t k = 0; k < layout.components; ++k) {
      const double value = component->value(bytes.data() + offset + i * stride + k * component->bytes);
      values.push_back(layout.normalized ? std::max(value / component->largest, -1.0) : value);
    }
  return values;
}

Result<std::vector<double>> GltfData::numbers(std::size_t accessor, std::size_t components,
                                              std::size_t most) const {
  const Result<const json*> found = item("accessors", accessor);
  if (!found) return found.error();
  const json& of = **found;
  const std::string place = "accessors/" + std::to_string(accessor);
  const auto type = of.find("type"), normalized = of.find("normalized");
  const std::string word = type != of.end() && type->is_string() ? type->get<std::string>() : "";
  const auto element = std::find_if(element_types.begin(), element_types.end(),
                                    [&](const auto& each) { return each.first == word; });
  if (element == element_types.end() || element->second != components)
    return wrong(place + " of the type " + quoted(word), std::to_string(components) + " numbers an element");
  const Result<std::size_t> component = whole(of, "componentType", 0), count = whole(of, "count", 0),
                            offset = whole(of, "byteOffset", 0), from = whole(of, "bufferView");
  for (const auto* each : {&component, &count, &offset, &from})
    if (!*each) return each->error();
  if (*count > most)
    return wrong(place + " of " + std::to_string(*count) + " elements", "at most " + std::to_string(most));
  const Layout layout{*component, components, *count,
                      normalized != of.end() && normalized->is_boolean() && normalized->get<bool>()};
  Result<std::vector<double>> values =
      *from == absent ? std::vector<double>(components * *count, 0.0) : block(*from, *offset, layout);
  if (!values) return values.error();
  if (const auto sparse = of.find("sparse"); sparse != of.end())
    if (const Status replaced = replace_sparse(*sparse, layout, *values); !replaced) return replaced.error();
  return values;
}

Status GltfData::replace_sparse(const json& sparse, const Layout& layout, std::vector<double>& values) const {
  const auto part = [&](const char* key) -> const json* {
    const auto found = sparse.find(key);
    return found != sparse.end() && found->is_object() ? &*found : nullptr;
  };
  if (!sparse.is_object() || !part("indices") || !part("values"))
    return wrong("a sparse accessor without indices and values", "both");
  const Result<std::size_t> count = whole(sparse, "count", 0),
                            type = whole(*part("indices"), "componentType", 0),
                            index_view = whole(*part("indices"), "bufferView"),
                            index_offset = whole(*part("indices"), "byteOffset", 0),
                            value_view = whole(*part("values"), "bufferView"),
                            value_offset = whole(*part("values"), "byteOffset", 0);
  for (const auto* each : {&count, &type, &index_view, &index_offset, &value_view, &value_offset})
    if (!*each) return each->error();
  if (*count > layout.count)
    return wrong("a sparse accessor with more elements than it has",
                 "at most " + std::to_string(layout.count));
  const Result<std::vector<double>> indices = block(*index_view, *index_offset, {*type, 1, *count, false});
  if (!indices) return indices.error();
  const Result<std::vector<double>> others =
      block(*value_view, *value_offset, {layout.type, layout.components, *count, layout.normalized});
  if (!others) return others.error();
  for (std::size_t i = 0; i < *count; ++i) {
    const double index = (*indices)[i];
    if (!(index >= 0.0 && index < static_cast<double>(layout.count)) || index != std::floor(index))
      return wrong("a sparse accessor's index that is not there", "0 to " + std::to_string(layout.count - 1));
    std::copy_n(
        others->begin() + static_cast<std::ptrdiff_t>(i * layout.components), layout.components,
        values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(index) * layout.components));
  }
  return ok();
}

}  // namespace clothlab::mesh
