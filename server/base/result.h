// Errors as values that say how to correct them. No exception leaves a thread, a callback or a public
// function.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace clothlab {

/// What went wrong, in three parts that every front end shows the same way.
/// In an error in a scene, `where` is a JSON Pointer, `what` the value found there (compact JSON), and
/// `remedy` what is allowed there.
struct Error {
  std::string where;    ///< file, line, JSON Pointer, or subsystem
  std::string what;     ///< what was found
  std::string remedy;   ///< what is allowed, or what to do
  std::string facts{};  ///< more of `what`, for programs: the members of a JSON object as text; empty: none

  /// "where: what; remedy" on one line, empty parts left out.
  std::string text() const;
};

/// A value or an Error.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() { return std::get<0>(state_); }
  const T& operator*() const { return std::get<0>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// The result of something that only succeeds or fails.
using Status = Result<std::monostate>;
inline Status ok() {
  return Status(std::monostate{});
}

}  // namespace clothlab
