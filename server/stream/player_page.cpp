#include "server/base/page_template.h"
#include "server/stream/recording.h"

namespace clothlab::stream {

namespace {

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

}  // namespace

Result<std::string> player_page(std::string_view recording, const std::string& title) {
  return filled_page("player.html", {{"@title@", as_html(title)}, {"@recording@", base64(recording)}});
}

}  // namespace clothlab::stream
