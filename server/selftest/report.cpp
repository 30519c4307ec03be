#include "server/selftest/report.h"

#include <glad/gl.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <utility>

#include "server/base/text.h"

namespace clothlab::selftest {

const char* const wrong_device =
    "update this device's driver; until it does this right take another device (--gpu N, see `clothlab "
    "info`), and report it with the file of --json";

Check at_most(std::string name, double found, double allowed, const std::string& unit,
              const std::string& said) {
  const bool passed = found <= allowed;  // false also for NaN
  const auto text = [&](double value) {
    return std::isfinite(value) ? with_significant_digits(value, 3) + " " + unit : std::string("no number");
  };
  return {std::move(name),
          passed,
          std::isfinite(found) ? json(found) : json("no number"),
          allowed,
          unit,
          text(found) + " " + said + ", " + text(allowed) + " allowed",
          passed ? "" : wrong_device};
}

Check failed(std::string name, const Error& error) {
  const std::string said = (error.where.empty() ? "" : error.where + ": ") + error.what;
  return {
      std::move(name), false, said, nullptr, {}, said, error.remedy.empty() ? wrong_device : error.remedy};
}

bool Report::wants(const std::string& name) const {
  return only_.empty() || std::any_of(only_.begin(), only_.end(),
                                      [&](const std::string& begins) { return name.starts_with(begins); });
}

void Report::add(Check check) {
  if (!wants(check.name)) return;
  checks_.push_back(std::move(check));
  told_(checks_.back());
}

void Report::make(const std::string& name, const std::function<Result<Check>()>& check) {
  if (!wants(name)) return;
  const auto made = [&]() -> Result<Check> {
    try {
      return check();
    } catch (const std::bad_alloc&) {
      return Error{"", "the device has too little memory", "free some of it, or take another device"};
    } catch (const std::exception& error) {
      return Error{"", error.what(), ""};
    }
  };
  while (glGetError() != GL_NO_ERROR && glGetError() != GL_CONTEXT_LOST) continue;
  Result<Check> result = made();
  const GLenum noted = glGetError();
  if (noted == GL_CONTEXT_LOST)
    result = Error{"OpenGL", "the device was reset in this check, and nothing after it can pass",
                   "look for the reason in the system's log (dmesg), and " + std::string(wrong_device)};
  else if (noted != GL_NO_ERROR && result && result->passed)
    result = Error{"OpenGL", formatted("the driver noted the error 0x%04x", noted), wrong_device};
  add(result ? std::move(*result) : selftest::failed(name, result.error()));
}

std::size_t Report::failed() const {
  return static_cast<std::size_t>(
      std::count_if(checks_.begin(), checks_.end(), [](const Check& check) { return !check.passed; }));
}

json Report::as_json(const std::string& device) const {
  json list = json::array();
  for (const Check& check : checks_) {
    json item{
        {"name", check.name}, {"passed", check.passed}, {"found", check.found}, {"allowed", check.allowed}};
    if (!check.unit.empty()) item["unit"] = check.unit;
    if (!check.remedy.empty()) item["remedy"] = check.remedy;
    list.push_back(std::move(item));
  }
  return {{"device", device}, {"passed", failed() == 0}, {"checks", std::move(list)}};
}

std::string line(const Check& check) {
  return (check.passed ? "ok    " : "WRONG ") + check.name + ": " + check.said +
         (check.remedy.empty() ? "" : "; " + check.remedy);
}

}  // namespace clothlab::selftest
