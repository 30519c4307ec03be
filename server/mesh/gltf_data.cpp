// The container, the JSON and the buffers of a glTF file.
#include "server/mesh/gltf_data.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "server/base/base64.h"
#include "server/mesh/text.h"

namespace clothlab::mesh {

namespace {

using nlohmann::json;

// Of the specification, section 4.4.
constexpr std::uint32_t glb_magic = 0x46546c67, glb_json = 0x4e4f534a, glb_binary = 0x004e4942;
constexpr int most_depth = 64;
constexpr std::size_t most_values = 2'000'000;
constexpr std::size_t largest_whole = std::size_t{1} << 40;  // so that products of a few do not overflow

static_assert(std::endian::native == std::endian::little, "glTF's numbers are read as they lie in memory");

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// "a%20b.bin" is "a b.bin".
std::string percent_decoded(const std::string& uri) {
  std::string text;
  const auto digit = [&](std::size_t at) {
    const std::size_t found = std::string_view("0123456789abcdef0123456789ABCDEF").find(uri[at]);
    return found == std::string_view::npos ? -1 : static_cast<int>(found % 16);
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(i + 1) >= 0 && digit(i + 2) >= 0) {
      text += static_cast<char>(16 * digit(i + 1) + digit(i + 2));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

}  // namespace

Status GltfData::open(std::string_view bytes) {
  if (const Status apart = take_apart(bytes); !apart) return apart.error();
  const json* asset = document_.contains("asset") ? &document_["asset"] : nullptr;
  const std::string version =
      asset && asset->is_object() && asset->contains("version") && (*asset)["version"].is_string()
          ? (*asset)["version"].get<std::string>()
          : "";
  if (!version.starts_with("2."))
    return wrong("glTF of version " + quoted(version), "glTF 2.0: export the file again in that version");
  return check_extensions();
}

Status GltfData::take_apart(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return parse(bytes);
  const Error cut = wrong("a .glb file that ends too early, or whose chunks do not fit into it",
                          "the whole file: is it complete?");
  if (bytes.size() < 20) return cut;
  if (word_at(bytes, 0) != glb_magic || word_at(bytes, 4) != 2)
    return wrong("a .glb file of version " + std::to_string(word_at(bytes, 4)),
                 "glTF 2.0: export the file again in that version");
  if (word_at(bytes, 8) > bytes.size()) return cut;
  bytes = bytes.substr(0, word_at(bytes, 8));
  std::string_view text;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t length = word_at(bytes, at), kind = word_at(bytes, at + 4);
    if (length > bytes.size() - at - 8) return cut;
    const std::string_view chunk = bytes.substr(at + 8, length);
    if (at == 12 && kind != glb_json)
      return wrong("a .glb file whose first chunk is no JSON", "a JSON chunk first");
    if (at == 12) text = chunk;
    if (at != 12 && kind == glb_binary && !has_binary_) {
      binary_ = chunk;
      has_binary_ = true;
    }
    at += 8 + (length + 3) / 4 * 4;
  }
  return parse(text);
}

Status GltfData::parse(std::string_view text) {
  std::size_t values = 0;
  bool deep = false;
  const auto keep = [&](int depth, json::parse_event_t, json&) {
    deep = deep || depth > most_depth;
    return !deep && ++values <= most_values;
  };
  document_ = json::parse(text.begin(), text.end(), keep, false);
  if (deep) return wrong("JSON nested more than " + std::to_string(most_depth) + " deep", "at most so deep");
  if (values > most_values)
    return wrong("more than " + std::to_string(most_values) + " values in its JSON", "at most so many");
  if (!document_.is_object()) return wrong("text that is no JSON object", "a .gltf or .glb file");
  return ok();
}

Status GltfData::check_extensions() const {
  // These change how surfaces look, and not where they are.
  constexpr std::string_view harmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                           "MSFT_texture_",  "KHR_lights_",  "KHR_mesh_quantization",
                                           "KHR_xmp"};
  const auto required = document_.find("extensionsRequired");
  if (required == document_.end() || !required->is_array()) return ok();
  for (const json& each : *required) {
    const std::string name = each.is_string() ? each.get<std::string>() : "";
    if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression")
      return wrong("a mesh that is compressed (" + name + ")",
                   "an export without compression, or what `npx @gltf-transform/cli copy` makes of the file");
    if (std::none_of(std::begin(harmless), std::end(harmless),
                     [&](std::string_view begin) { return name.starts_with(begin); }))
      return wrong("the extension " + quoted(name) + ", which the file requires", "an export without it");
  }
  return ok();
}

std::size_t GltfData::count(const char* list) const {
  const auto found = document_.find(list);
  return found != document_.end() && found->is_array() ? found->size() : 0;
}

Result<const json*> GltfData::item(const char* list, std::size_t index) const {
  const std::size_t size = count(list);
  const std::string place = std::string(list) + "/" + std::to_string(index);
  if (index >= size)
    return wrong(place + ", which is not there", std::to_string(size) + " are in the file: 0 and up");
  const json& found = (*document_.find(list))[index];
  if (!found.is_object()) return wrong(place + ", which is no object", "an object");
  return &found;
}

Result<std::size_t> GltfData::whole(const json& of, const char* key, std::size_t otherwise) const {
  const auto found = of.find(key);
  if (found == of.end()) return otherwise;
  if (found->is_number_unsigned() && found->get<std::uint64_t>() <= largest_whole)
    return static_cast<std::size_t>(found->get<std::uint64_t>());
  return wrong(quoted(found->is_structured() ? std::string(found->type_name())
                                             : found->dump(-1, ' ', true, json::error_handler_t::replace)) +
                   " as " + key,
               "a whole number, 0 or more");
}

std::string GltfData::name_of(const json& of) {
  const auto name = of.find("name");
  return name != of.end() && name->is_string() ? name->get<std::string>() : "";
}

Result<std::string> GltfData::fetch(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos)
      return wrong("a buffer in the file that is not base64", "data:application/octet-stream;base64,...");
    std::optional<std::string> bytes = from_base64(uri.substr(comma + 1));
    if (!bytes) return wrong("a buffer in the file that is no base64", "base64 (RFC 4648), padded");
    return std::move(*bytes);
  }
  const std::string path = percent_decoded(uri);
  if (path.find("://") != std::string::npos || !beside_)
    return wrong("the buffer " + quoted(path) + ", which is not in the file",
                 "one file: an export as .glb, or with embedded buffers");
  return beside_(path);
}

Result<std::string_view> GltfData::buffer(std::size_t index) const {
  if (const auto read = buffers_.find(index); read != buffers_.end()) return std::string_view(read->second);
  const Result<const json*> found = item("buffers", index);
  if (!found) return found.error();
  const Result<std::size_t> length = whole(**found, "byteLength", 0);
  if (!length) return length.error();
  const auto uri = (*found)->find("uri");
  std::string bytes;
  if (uri != (*found)->end() && uri->is_string()) {
    Result<std::string> fetched = fetch(uri->get_ref<const std::string&>());
    if (!fetched) return fetched.error();
    bytes = std::move(*fetched);
  } else if (index == 0 && has_binary_) {
    bytes = binary_;
  } else {
    return wrong("buffers/" + std::to_string(index) + " without bytes",
                 "a \"uri\", or the chunk of a .glb file");
  }
  if (bytes.size() < *length)
    return wrong(
        "a buffer of " + std::to_string(bytes.size()) + " bytes that should have " + std::to_string(*length),
        "the whole buffer: is the file complete?");
  bytes.resize(*length);
  buffer_bytes_ += bytes.size();
  if (buffer_bytes_ > limits_.bytes)
    return wrong("buffers of " + std::to_string(buffer_bytes_) + " bytes and more",
                 "at most " + std::to_string(limits_.bytes));
  return std::string_view(buffers_[index] = std::move(bytes));
}

}  // namespace clothlab::mesh
