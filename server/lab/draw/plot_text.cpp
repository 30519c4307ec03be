// Text in a picture: numbers as text, escaping, and the width of words.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "server/base/text.h"
#include "server/lab/draw/plot.h"

namespace clothlab::lab {

namespace {

/// The approximate width of a character in DejaVu Sans, the widest of the usual fonts, over the font size.
double advance(unsigned char character) {
  if (std::strchr("ijlI.,:;'|! ", character)) return 0.32;
  if (std::strchr("ftr()[]/-\"", character)) return 0.42;
  if (std::strchr("mMwWQ%@", character)) return 0.95;
  if (character >= 'A' && character <= 'Z') return 0.7;
  return 0.63;
}

/// True for a byte of a UTF-8 character after its first.
bool continues(unsigned char byte) {
  return (byte & 0xC0) == 0x80;
}

/// The longest beginning of `text` that fits into `width` with an ellipsis. It ends with a whole character.
std::string cut(std::string text, double width, double font_size) {
  while (!text.empty() && text_width(text + "…", font_size) > width) {
    while (!text.empty() && continues(static_cast<unsigned char>(text.back()))) text.pop_back();
    if (!text.empty()) text.pop_back();
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == ',')) text.pop_back();
  return text + "…";
}

}  // namespace

std::string brief(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const std::string text = with_significant_digits(value, digits);
  const std::size_t exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  const int power = std::atoi(text.c_str() + exponent + 1);
  // 5.7e4 is shorter than 57000, but 57000 is easier to read, e.g. as milliseconds.
  if (power >= 0 && power < 6) return formatted("%.0f", std::atof(text.c_str()));
  return text.substr(0, exponent) + "e" + std::to_string(power);
}

std::string count(std::size_t number, const std::string& one, const std::string& many) {
  return std::to_string(number) + " " + (number == 1 ? one : many.empty() ? one + "s" : many);
}

std::string escaped(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char character : text) switch (character) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(character) >= ' ' || character == '\n' || character == '\t')
          safe += character;
    }
  return safe;
}

double text_width(const std::string& text, double font_size) {
  double width = 0;
  for (const char character : text)
    if (!continues(static_cast<unsigned char>(character)))
      width += advance(static_cast<unsigned char>(character));
  return width * font_size;
}

std::vector<std::string> wrapped(const std::string& text, double width, double font_size, std::size_t most) {
  std::vector<std::string> lines;
  std::string line;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && text_width(longer, font_size) > width) {
      if (lines.size() + 1 == most) {
        lines.push_back(cut(line + " " + text.substr(at), width, font_size));
        return lines;
      }
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
    at = end + 1;
  }
  // A single word may be too long for a line.
  if (!line.empty())
    lines.push_back(text_width(line, font_size) > width ? cut(line, width, font_size) : line);
  return lines;
}

}  // namespace clothlab::lab
