// The checks of a selftest, and what is said of each: one line for a person, and the same for programs.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::selftest {

using nlohmann::json;

struct Check {
  std::string name;  ///< "scene: swing, verlet"; of each check another one, the same in every version
  bool passed = false;
  json found;            ///< what the device does: a number, or a text
  json allowed;          ///< a number is the most that `found` may be; null: no bound
  std::string unit{};    ///< of both numbers, e.g. "m"
  std::string said{};    ///< what is right, or what is wrong, in words
  std::string remedy{};  ///< what to do about it; empty if it passed
};

/// What to do about a device whose results are wrong.
extern const char* const wrong_device;

/// A check of a number that must be at most `allowed`. `said` is about the number: "from the reference".
Check at_most(std::string name, double found, double allowed, const std::string& unit,
              const std::string& said);
/// A check that could not be made.
Check failed(std::string name, const Error& error);

class Report {
 public:
  using Told = std::function<void(const Check&)>;
  /// `told` is called with each check as it is made. Of `only` none is made whose name begins with none of
  /// these; empty: all are.
  explicit Report(Told told, std::vector<std::string> only = {})
      : told_(std::move(told)), only_(std::move(only)) {}

  void add(Check check);
  /// Makes a check that may not end: an error, an exception, or an error that OpenGL has noted become a
  /// failed check of this name.
  void make(const std::string& name, const std::function<Result<Check>()>& check);

  const std::vector<Check>& checks() const { return checks_; }
  std::size_t failed() const;
  /// {"device", "passed", "checks": [{"name", "passed", "found", "allowed", "unit", "remedy"}]}; the last two
  /// only where there is one.
  json as_json(const std::string& device) const;

 private:
  bool wants(const std::string& name) const;

  Told told_;
  std::vector<std::string> only_;
  std::vector<Check> checks_;
};

/// "ok    NAME: SAID" or "WRONG NAME: SAID; REMEDY"
std::string line(const Check& check);

}  // namespace clothlab::selftest
