// Any text as a scene: read, validated, built. An accepted scene validates to itself; an error says where it
// is, what was found there and what is allowed.
#include "tests/fuzz/document.h"

using namespace clothlab;

namespace {

/// True if `pointer` names a part of `value`, or a missing key of such a part.
bool exists(scene::json value, const std::string& pointer) {
  const std::vector<std::string> tokens = *scene::split_pointer(pointer);
  scene::json* at = &value;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i)
    if (!(at = scene::child(*at, tokens[i]))) return false;
  return tokens.empty() || at->is_structured();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of(data, size);
  const Result<scene::json> value = scene::parse_json(text, "input", true);
  if (!value) {
    fuzz::require_complete(value.error());
    return 0;
  }
  fuzz::require(static_cast<std::size_t>(scene::depth(*value)) <= scene::max_json_depth,
                "what was read is not too deep");
  const Result<scene::Document> document = scene::validate(*value);
  if (!document) {
    fuzz::require_pointer(document.error());
    fuzz::require(exists(*value, document.error().where), "an error points into the document",
                  document.error().text());
    return 0;
  }
  fuzz::require_settled(*document);
  fuzz::require_model(document->scene);
  return 0;
}
