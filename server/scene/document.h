// The scene document: JSON as the user wrote it with every default filled in, the typed Scene it means, and patches.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

using nlohmann::json;

/// A valid scene as JSON and as plain data, always in step with each other.
struct Document {
  json value;   ///< every key of contract.md present, defaults filled in
  Scene scene;
};

/// Limits on untrusted text, checked while parsing, before a value exists.
inline constexpr std::size_t max_json_bytes = 64 * 1024;  ///< one message [bytes]
inline constexpr int max_json_depth = 32;

/// Parses JSON text (comments allowed when `comments`), refusing anything deeper than max_json_depth.
/// Error: where = `source` and position.
Result<json> parse_json(const std::string& text, const std::string& source, bool comments = false);

/// Validates the whole document and fills in defaults. Error: JSON Pointer, found, allowed.
Result<Document> validate(json value);

/// Applies an RFC 7396 merge patch (object) or an RFC 6902 patch (array) and validates the outcome.
/// On error `document` is what was there before (the function does not touch it).
Result<Document> apply_patch(const Document& document, const json& patch);

/// A patch of one value by JSON Pointer, for `--set /solver/dt=0.0005`: `text` is JSON, or else a plain string.
Result<Document> set_value(const Document& document, const std::string& assignment);

/// Names of the presets, the seed first.
std::vector<std::string> preset_names();

/// A preset by name. Error names the presets there are.
Result<Document> load_preset(const std::string& name);

/// A preset's name, or the path of a scene file (JSON, `//` comments allowed).
Result<Document> load(const std::string& preset_or_path);

}  // namespace clothlab::scene
