// Reads untrusted JSON and checks it: each Reader is one value and its JSON Pointer. The first error is kept,
// and a wrong value reads as a harmless default, so that code that uses a Reader need not handle errors.
#pragma once

#include <glm/vec3.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/ranges.h"

namespace clothlab::scene {

using glm::dvec3;
using nlohmann::json;
using Words = std::vector<std::string>;

class Reader {
 public:
  /// `error` receives the first error. It must outlive this Reader and every Reader made from it.
  Reader(json* value, std::string pointer, std::optional<Error>& error)
      : value_(value), pointer_(std::move(pointer)), error_(&error) {}

  /// Checks that this is an object with only `keys`.
  void object(const Words& keys) const;
  /// The key of `alternatives` that the object has; an error unless it has exactly one of them.
  std::string exactly_one(const Words& alternatives) const;
  bool has(const std::string& key) const;
  /// The keys of an object that has any names as keys, up to `maximum`; an error if it is none, or has more.
  Words keys(std::size_t maximum) const;
  /// The member `key`. If it is absent, `fallback` is written into the document; without a fallback reading
  /// the member is an error.
  Reader member(const std::string& key, const std::optional<json>& fallback = std::nullopt) const;

  /// Checks an array's length and returns it.
  std::size_t array(std::size_t minimum, std::size_t maximum) const;
  Reader element(std::size_t index) const;

  /// True if an error is recorded, of this value or any other.
  bool failed() const { return error_->has_value(); }
  bool is_null() const { return value_ && value_->is_null(); }
  bool is_object() const { return value_ && value_->is_object(); }
  bool is_string() const { return value_ && value_->is_string(); }
  bool boolean(bool otherwise) const;  ///< `otherwise` after an error
  double number(const Range& range) const;
  int integer(const Range& range) const;  ///< accepts 3.0, too: to JSON it is the same number as 3
  dvec3 vector(const Range& range) const;
  dvec3 direction() const;  ///< three numbers, not all 0, scaled to unit length
  std::string string(const std::string& allowed) const;
  std::string name() const;
  std::string choice(const Words& choices) const;

  /// Records that this value is wrong, unless an earlier error is recorded; `allowed` says what it may be.
  void fail(const std::string& allowed) const;
  void fail(const std::string& found, const std::string& allowed) const;

 private:
  json* value_;  ///< null if the value is absent
  std::string pointer_;
  std::optional<Error>* error_;
};

/// `"a", "b", "c"`.
std::string quoted(const Words& words);
/// `; did you mean "x"?` for the nearest of `words`, if it is near enough for `word` to be a typing error.
std::string suggestion(const std::string& word, const Words& words);

}  // namespace clothlab::scene
