#include "server/model/gltf_parts.h"

#include <bit>

namespace clothlab::model::gltf {

namespace {

static_assert(std::endian::native == std::endian::little, "a .glb file has numbers as they lie in memory");

constexpr std::uint32_t magic = 0x46546c67, version = 2, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

}  // namespace

std::string binary_file_head(const nlohmann::json& document, std::uint64_t binary_bytes) {
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string head;
  const auto append = [&head](std::uint64_t number) {
    const auto word = static_cast<std::uint32_t>(number);
    head.append(reinterpret_cast<const char*>(&word), sizeof word);
  };
  append(magic);
  append(version);
  append(28 + text.size() + binary_bytes);
  append(text.size());
  append(json_chunk);
  head += text;
  append(binary_bytes);
  append(binary_chunk);
  return head;
}

nlohmann::json material(const std::string& name, const std::array<double, 3>& linear_colour) {
  const auto& [red, green, blue] = linear_colour;
  return {
      {"name", name},
      {"doubleSided", true},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {red, green, blue, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}}};
}

}  // namespace clothlab::model::gltf
