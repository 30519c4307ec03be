// The scene document: JSON as the user wrote it with every default filled in, the typed Scene it means, and
// patches. No function here throws; whatever the text, each answers with a value or an Error.
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
  json value;  ///< every key of the schema present, defaults filled in, the user's numbers as they were
               ///< written
  Scene scene;
  bool operator==(const Document&) const = default;
};

/// Limits on untrusted text, checked while parsing, before a value exists.
inline constexpr std::size_t max_json_bytes = 64 * 1024;         ///< one message [bytes]
inline constexpr std::size_t max_file_bytes = 64 * 1024 * 1024;  ///< a scene file [bytes]
inline constexpr std::size_t max_json_depth = 32;
/// Operations in one RFC 6902 patch.
inline constexpr std::size_t max_patch_operations = 1024;

struct TextLimits {
  std::size_t bytes = max_json_bytes;
  std::size_t depth = max_json_depth;
};

/// Parses JSON text (comments allowed when `comments`), refusing repeated keys and anything beyond `limits`.
/// Error: where = `source`, line and column.
Result<json> parse_json(const std::string& text, const std::string& source, bool comments = false,
                        TextLimits limits = {});

/// Validates the whole document and fills in defaults. Error: JSON Pointer, found, allowed.
Result<Document> validate(json value);

/// Applies an RFC 7396 merge patch (object) or an RFC 6902 patch (array) and validates the outcome.
/// A merge patch removes a key with null; an absent key means its default, and the default of a key that may
/// be null (self_collision, wind, motion, start, strain_limit) is null: `{"self_collision": null}` turns
/// self-collision off. On error `document` is what was there before (the function does not touch it); the
/// error's pointer is into the patched scene, or, for an operation that cannot be carried out,
/// "/patch/INDEX/...".
Result<Document> apply_patch(const Document& document, const json& patch);

/// A patch of one value by JSON Pointer, for `--set /solver/dt=0.0005`: `text` is JSON, or else a plain
/// string. Absent or null parents become objects; index `-` appends to an array.
Result<Document> set_value(const Document& document, const std::string& assignment);

struct Preset {
  std::string name;
  std::string description;  ///< one line
};

/// The presets, the seed first.
const std::vector<Preset>& presets();
std::vector<std::string> preset_names();

/// A preset by name. Error names the presets there are.
Result<Document> load_preset(const std::string& name);

/// A preset's name, or the path of a scene file (JSON, `//` comments allowed).
Result<Document> load(const std::string& preset_or_path);

}  // namespace clothlab::scene
