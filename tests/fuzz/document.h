// Properties of every accepted scene document, and of every error about a document.
#pragma once

#include "server/model/model.h"
#include "server/scene/document.h"
#include "server/scene/pointer.h"
#include "tests/fuzz/fuzz.h"

namespace clothlab::fuzz {

/// The document validates to itself, and so does its own text.
inline void require_settled(const scene::Document& document) {
  const Result<scene::Document> again = scene::validate(document.value);
  require(bool(again), "a validated document validates", again ? "" : again.error().text());
  require(*again == document, "a validated document validates to itself");
  const std::string text = document.value.dump();
  if (text.size() > scene::max_json_bytes) return;
  const Result<scene::json> read = scene::parse_json(text, "dump");
  require(bool(read), "a document's text is read", read ? "" : read.error().text());
  require(*read == document.value, "a document's text reads as the document");
}

/// The error is complete, `where` is a JSON Pointer, and all its text can be sent.
inline void require_pointer(const Error& error) {
  require_complete(error);
  require(scene::split_pointer(error.where).has_value(), "an error's place is a JSON Pointer", error.where);
  require(is_utf8(error.where) && is_utf8(error.what) && is_utf8(error.remedy), "an error is UTF-8",
          error.text());
}

/// Number of vertices that a scene would build.
std::size_t vertex_count(const scene::Scene& scene);

/// The arrays have matching sizes, every number fits float32, and the model agrees with the scene.
void require_sound(const model::Model& model, const scene::Scene& scene);

/// Builds the scene's model if it is small enough to be built often: the model is sound, or an error points
/// to the cause.
void require_model(const scene::Scene& scene);

}  // namespace clothlab::fuzz
