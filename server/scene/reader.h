// A checked walk through untrusted JSON: each Reader is one value and its JSON Pointer. The first thing that
// is wrong is kept and everything after it reads as a harmless default, so that the code of a section reads
// as if nothing could fail.
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
  /// `error` receives the first thing that is wrong and outlives every Reader made from this one.
  Reader(json* value, std::string pointer, std::optional<Error>& error)
      : value_(value), pointer_(std::move(pointer)), error_(&error) {}

  /// An object without any key but `keys`; a key of `later` is refused as "not supported yet".
  void object(const Words& keys, const Words& later = {}) const;
  /// The one key of `alternatives` that the object has.
  std::string exactly_one(const Words& alternatives) const;
  bool has(const std::string& key) const;
  /// A member. Where it is absent, `fallback` is written into the document; without a fallback it is
  /// required.
  Reader member(const std::string& key, const std::optional<json>& fallback = std::nullopt) const;

  /// Checks an array's length and returns it.
  std::size_t array(std::size_t minimum, std::size_t maximum) const;
  Reader element(std::size_t index) const;

  bool is_null() const { return value_ && value_->is_null(); }
  bool is_string() const { return value_ && value_->is_string(); }
  double number(const Range& range) const;
  int integer(const Range& range) const;  ///< 3.0 is an integer too: JSON does not tell them apart
  dvec3 vector(const Range& range) const;
  dvec3 direction() const;  ///< three numbers, not all 0, normalised
  std::string string(const std::string& allowed) const;
  std::string name() const;
  std::string choice(const Words& choices, const Words& later = {}) const;

  /// Records that this value is wrong.
  void fail(const std::string& allowed) const;
  void fail(const std::string& found, const std::string& allowed) const;

 private:
  json* value_;  ///< null: absent
  std::string pointer_;
  std::optional<Error>* error_;
};

/// `"a", "b", "c"`.
std::string quoted(const Words& words);

}  // namespace clothlab::scene
