// The lab's simplification of a scene, and its parts by their names.
#pragma once

#include <string>

#include "server/lab/measure/parts.h"
#include "server/lab/measure/simplification.h"
#include "tests/scenes.h"

namespace clothlab::test {

inline const lab::Variant& variant(const lab::Simplification& result, const std::string& name) {
  for (const lab::Variant& each : result.variants)
    if (each.name == name) return each;
  FAIL("no variant " << name);
  return result.whole;
}

inline lab::Simplification simplified(const scene::Document& document, const lab::SimplifyRequest& request) {
  const Result<lab::Simplification> result = lab::simplify(document, request, {});
  INFO((result ? "" : result.error().text()));
  REQUIRE(result);
  CHECK(result->complete);
  CHECK(result->variants.size() == lab::parts(document).size());
  return *result;
}

}  // namespace clothlab::test
