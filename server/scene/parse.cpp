// Parses JSON text. Size, depth and repeated keys are checked before or while a value is built: nlohmann_json
// would run out of stack when it copies or prints a value that is nested too deep.
#include <algorithm>
#include <cstddef>
#include <iterator>

#include "server/scene/document.h"
#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

/// Walks over the text and counts the bytes read, so that Builder can tell where a problem is.
struct CountingIterator {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at = nullptr;
  std::size_t* count = nullptr;

  reference operator*() const { return *at; }
  CountingIterator& operator++() {
    ++at;
    ++*count;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at == other.at; }
  bool operator!=(const CountingIterator& other) const { return at != other.at; }
};

class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(const std::size_t& position, std::size_t deepest) : position_(position), deepest_(deepest) {}

  json value;
  std::string problem, remedy;  ///< empty if there is no problem
  std::size_t problem_at = 0;   ///< bytes from the start

  bool null() override { return put(nullptr); }
  bool boolean(bool b) override { return put(b); }
  bool number_integer(number_integer_t n) override { return put(n); }
  bool number_unsigned(number_unsigned_t n) override { return put(n); }
  bool number_float(number_float_t n, const string_t&) override { return put(n); }
  bool string(string_t& s) override { return put(std::move(s)); }
  bool binary(binary_t&) override { return refuse("binary data", "JSON text"); }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_array() override { return close(); }

  bool key(string_t& key) override {
    if (open_.back()->contains(key))
      return refuse("the key " + compact(key) + " a second time", "each key once");
    key_ = std::move(key);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const json::exception& failure) override {
    const std::string text = failure.what();
    // Cuts "[json.exception.parse_error.101] parse error at line 1, column 2: " off: Error::where has the
    // place.
    std::size_t begin = text.find(": ");
    begin = begin == std::string::npos ? text.find("] ") : begin;
    problem = begin == std::string::npos ? text : text.substr(begin + 2);
    remedy = "JSON text (RFC 8259)";
    problem_at = position > 0 ? position - 1 : 0;
    return false;
  }

 private:
  json* put(json&& item, bool) {
    if (open_.empty()) return &(value = std::move(item));
    json& parent = *open_.back();
    if (parent.is_object()) return &(parent[key_] = std::move(item));
    parent.push_back(std::move(item));
    return &parent.back();
  }
  bool put(json&& item) { return put(std::move(item), true) != nullptr; }

  bool open(json&& container) {
    if (open_.size() == deepest_)
      return refuse("more than " + std::to_string(deepest_) + " levels of nesting",
                    "at most " + std::to_string(deepest_));
    open_.push_back(put(std::move(container), true));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  bool refuse(std::string what, std::string allowed) {
    problem = std::move(what);
    remedy = std::move(allowed);
    problem_at = position_ > 0 ? position_ - 1 : 0;
    return false;
  }

  const std::size_t& position_;
  const std::size_t deepest_;
  // The open containers, outermost first. The pointers stay valid: no parent grows while its child is open.
  std::vector<json*> open_;
  std::string key_;
};

std::string line_and_column(const std::string& text, std::size_t at) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size()));
  const auto line = std::count(text.begin(), end, '\n') + 1;
  const auto line_start = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
  return "line " + std::to_string(line) + ", column " + std::to_string(end - line_start + 1);
}

}  // namespace

Result<json> parse_json(const std::string& text, const std::string& source, bool comments,
                        TextLimits limits) {
  if (text.size() > limits.bytes)
    return Error{source, std::to_string(text.size()) + " bytes of JSON",
                 "at most " + std::to_string(limits.bytes)};
  std::size_t position = 0;
  Builder builder(position, limits.depth);
  const CountingIterator begin{text.data(), &position}, end{text.data() + text.size(), &position};
  const bool read = json::sax_parse(begin, end, &builder, json::input_format_t::json, true, comments);
  // nlohmann_json takes a zero byte for the end of the text and ignores all that follows.
  const std::size_t zero = text.find('\0');
  if (read && zero == std::string::npos) return std::move(builder.value);
  if (read) {
    builder.problem = "a zero byte";
    builder.remedy = "JSON text (RFC 8259)";
    builder.problem_at = zero;
  }
  const std::string place = line_and_column(text, builder.problem_at);
  return Error{source.empty() ? place : source + ", " + place, builder.problem, builder.remedy};
}

}  // namespace clothlab::scene
