// The scene document: the user's JSON with every default filled in, the typed Scene it describes, and
// patches. No function here throws: on bad input it returns an Error.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/assets.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

using nlohmann::json;

/// A valid scene in two forms, JSON and plain data, which always agree.
struct Document {
  /// With every key of the schema, defaults filled in; the user's numbers are unchanged. What a cloth leaves
  /// to the fabric that it names stays absent: see named_fabric.h.
  json value;
  Scene scene;
  std::shared_ptr<const Assets> assets{};  ///< where the meshes that it names are; null: it may name none
  bool operator==(const Document& other) const { return value == other.value && scene == other.scene; }
};

/// Limits on untrusted text, checked before or while it is parsed.
inline constexpr std::size_t max_json_bytes = 64 * 1024;         ///< one message [bytes]
inline constexpr std::size_t max_file_bytes = 64 * 1024 * 1024;  ///< a scene file [bytes]
inline constexpr std::size_t max_json_depth = 32;                ///< levels of nesting
/// A document that is served, as compact JSON with its defaults [bytes]: each client gets all of it as one
/// message, beside which others must fit into what may wait for a client that reads slowly.
inline constexpr std::size_t max_document_bytes = 3 * 1024 * 1024;
/// The most operations in one RFC 6902 patch.
inline constexpr std::size_t max_patch_operations = 1024;

struct TextLimits {
  std::size_t bytes = max_json_bytes;
  std::size_t depth = max_json_depth;
};

/// Parses JSON text (with comments if `comments`); refuses repeated keys and text beyond `limits`. The place
/// of the error is `source`, line and column.
Result<json> parse_json(const std::string& text, const std::string& source, bool comments = false,
                        TextLimits limits = {});

/// Validates the whole document, fills in defaults and gets the meshes that it names from `assets`. Errors
/// say the JSON Pointer, what was found and what is allowed.
Result<Document> validate(json value, std::shared_ptr<const Assets> assets = nullptr);

/// Error: as a document that is served it has more than `max_document_bytes`.
Status check_bytes(const json& document);

/// Applies an RFC 7396 merge patch (object) or an RFC 6902 patch (array) and validates the outcome. A merge
/// patch removes a key with null; an absent key means its default, and the default of a key that may be null
/// (self_collision, wind, motion, start, strain_limit) is null: `{"self_collision": null}` turns
/// self-collision off. Error: a JSON Pointer into the patched scene, or "/patch/INDEX/..." for an operation
/// that cannot be carried out.
Result<Document> apply_patch(const Document& document, const json& patch);

/// What the operations of one RFC 6902 patch may do beside the patch's own length. Without the limits of
/// copies a patch could double the document with every operation, by copying it into itself; the others limit
/// time: a move counts the values that it moves, what is put into a list or taken out those after it.
struct PatchLimits {
  std::size_t copied_values = 1u << 20;
  std::size_t copied_bytes = 16u << 20;  ///< as compact JSON
  std::size_t moved_values = 1u << 23;
  std::size_t shifted_values = 1u << 28;
};
/// The outcome of either kind of patch, which is not validated. Errors as of apply_patch.
Result<json> patched(json target, const json& patch, const PatchLimits& limits = {});

/// Sets one value and validates the outcome. `assignment` is POINTER=VALUE, e.g. /solver/dt=0.0005: a JSON
/// Pointer, then JSON or a plain string. Absent or null parents become objects; `-` as an index
/// appends to an array.
Result<Document> set_value(const Document& document, const std::string& assignment);

struct Preset {
  std::string name;
  std::string description;  ///< one line
};

/// All presets, "seed" first.
const std::vector<Preset>& presets();
std::vector<std::string> preset_names();

/// Loads a preset by its name. The error for an unknown name lists the presets.
Result<Document> load_preset(const std::string& name, std::shared_ptr<const Assets> assets = nullptr);

/// Loads a preset by its name, or a scene file by its path (JSON, comments allowed).
Result<Document> load(const std::string& preset_or_path, std::shared_ptr<const Assets> assets = nullptr);

/// True if it is the name of a preset, else it is the path of a scene file.
bool is_preset(const std::string& name);

}  // namespace clothlab::scene
