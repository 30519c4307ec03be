#include "server/scene/reader.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/base/text.h"
#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

bool contains(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Levenshtein distance.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string range_text(const char* kind, const Range& range) {
  const std::string text = formatted("%s from %g to %g", kind, range.minimum, range.maximum);
  return *range.unit ? text + " [" + range.unit + "]" : text;
}

bool inside(double x, const Range& range) {
  return x >= range.minimum && x <= range.maximum;
}  // false for NaN

}  // namespace

std::string suggestion(const std::string& word, const Words& words) {
  if (word.size() > max_name_length) return "";
  const std::string* nearest = nullptr;
  std::size_t fewest = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance = edits(word, candidate);
    if (distance >= fewest) continue;
    fewest = distance;
    nearest = &candidate;
  }
  return nearest ? "; did you mean \"" + *nearest + "\"?" : "";
}

std::string quoted(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "\"" : ", \"") + word + "\"";
  return text;
}

void Reader::fail(const std::string& allowed) const {
  fail(value_ ? compact(*value_) : "nothing", allowed);
}

void Reader::fail(const std::string& found, const std::string& allowed) const {
  if (!*error_) *error_ = Error{pointer_, found, allowed};
}

void Reader::object(const Words& keys) const {
  if (!value_ || !value_->is_object()) return fail("an object with the keys " + quoted(keys));
  for (auto item = value_->begin(); item != value_->end(); ++item) {
    const std::string& key = item.key();
    if (contains(keys, key)) continue;
    const Reader culprit(&*item, pointer_ + "/" + escape_token(key), *error_);
    return culprit.fail("unknown key " + compact(key), "one of " + quoted(keys) + suggestion(key, keys));
  }
}

std::string Reader::exactly_one(const Words& alternatives) const {
  std::string chosen;
  std::size_t count = 0;
  for (const std::string& key : alternatives) {
    if (!has(key)) continue;
    chosen = key;
    ++count;
  }
  if (count != 1)
    fail("exactly one of " + quoted(alternatives) + " (a merge patch drops the other with null)");
  return chosen;
}

Words Reader::keys(std::size_t maximum) const {
  Words names;
  if (!value_ || !value_->is_object()) {
    fail("an object");
    return names;
  }
  if (value_->size() > maximum)
    fail(std::to_string(value_->size()) + " keys", "at most " + std::to_string(maximum));
  else
    for (auto item = value_->begin(); item != value_->end(); ++item) names.push_back(item.key());
  return names;
}

bool Reader::has(const std::string& key) const {
  return value_ && value_->is_object() && value_->contains(key);
}

Reader Reader::member(const std::string& key, const std::optional<json>& fallback) const {
  json* found = nullptr;
  if (value_ && value_->is_object()) {
    if (fallback) value_->emplace(key, *fallback);
    found = child(*value_, key);
  }
  return Reader(found, pointer_ + "/" + escape_token(key), *error_);
}

std::size_t Reader::array(std::size_t minimum, std::size_t maximum) const {
  const std::string allowed =
      "an array of " + std::to_string(minimum) + " to " + std::to_string(maximum) + " elements";
  if (!value_ || !value_->is_array()) {
    fail(allowed);
    return 0;
  }
  if (value_->size() >= minimum && value_->size() <= maximum) return value_->size();
  fail(std::to_string(value_->size()) + " elements", allowed);
  return 0;
}

Reader Reader::element(std::size_t index) const {
  return Reader(&(*value_)[index], pointer_ + "/" + std::to_string(index), *error_);
}

bool Reader::boolean(bool otherwise) const {
  if (value_ && value_->is_boolean()) return value_->get<bool>();
  fail("true or false");
  return otherwise;
}

double Reader::number(const Range& range) const {
  if (value_ && value_->is_number() && inside(value_->get<double>(), range)) return value_->get<double>();
  fail(range_text("a number", range));
  return range.minimum;
}

int Reader::integer(const Range& range) const {
  if (value_ && value_->is_number()) {
    const double x = value_->get<double>();
    if (inside(x, range) && x == std::floor(x)) return static_cast<int>(x);
  }
  fail(range_text("a whole number", range));
  return static_cast<int>(range.minimum);
}

dvec3 Reader::vector(const Range& range) const {
  if (!value_ || !value_->is_array() || value_->size() != 3) {
    fail("an array of three numbers, each" + range_text("", range));
    return dvec3(0.0);
  }
  return dvec3(element(0).number(range), element(1).number(range), element(2).number(range));
}

dvec3 Reader::direction() const {
  const dvec3 v = vector(ranges::direction);
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest > 0) return glm::normalize(v / largest);  // scaled first, because the square of 1e-200 is 0
  fail("a direction: three numbers, not all of them 0");
  return dvec3(0.0, 1.0, 0.0);
}

std::string Reader::string(const std::string& allowed) const {
  if (value_ && value_->is_string()) return value_->get<std::string>();
  fail(allowed);
  return "";
}

std::string Reader::name() const {
  const std::string allowed =
      "a text of 1 to " + std::to_string(max_name_length) + " characters, none of them a control character";
  const std::string text = string(allowed);
  const auto is_control = [](char c) { return (c >= 0 && c < 0x20) || c == 0x7f; };
  const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
  const auto length = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_character));
  if (length < 1 || length > max_name_length || std::any_of(text.begin(), text.end(), is_control))
    fail(allowed);
  return text;
}

std::string Reader::choice(const Words& choices) const {
  const std::string text = string("one of " + quoted(choices));
  if (!contains(choices, text)) fail("one of " + quoted(choices) + suggestion(text, choices));
  return text;
}

}  // namespace clothlab::scene
