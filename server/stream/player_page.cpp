#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/stream/recording.h"

namespace clothlab::stream {

namespace {

constexpr const char* page_file = "web/dist/player.html";
constexpr std::string_view title_place = "@title@", recording_place = "@recording@";

std::string base64(std::string_view bytes) {
  static constexpr std::string_view letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t word = 0;
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - at);
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < there ? static_cast<std::uint8_t>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= there ? letters[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char letter : text)
    if (letter == '<')
      out += "&lt;";
    else if (letter == '&')
      out += "&amp;";
    else
      out += letter;
  return out;
}

bool fill_in(std::string& page, std::string_view place, const std::string& text) {
  const std::size_t at = page.find(place);
  if (at == std::string::npos) return false;
  page.replace(at, place.size(), text);
  return true;
}

}  // namespace

Result<std::string> player_page(std::string_view recording, const std::string& title) {
  const Error not_built{page_file, "the player has not been built",
                        "run `npm --prefix web ci` and `npm --prefix web run build`"};
  const Result<std::filesystem::path> path = data_path(page_file);
  if (!path) return not_built;
  Result<std::string> page = read_file(*path);
  if (!page) return page.error();
  if (!fill_in(*page, title_place, escaped(title)) || !fill_in(*page, recording_place, base64(recording)))
    return not_built;
  return page;
}

}  // namespace clothlab::stream
