// Patches of the scene document: RFC 7396 (merge) and RFC 6902 (a list of operations). Both work on a copy of
// the document.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "server/scene/document.h"
#include "server/scene/named_fabric.h"
#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

std::size_t value_count(const json& value) {
  std::size_t count = 1;
  if (value.is_structured())
    for (const json& element : value) count += value_count(element);
  return count;
}

using Tokens = std::vector<std::string>;

/// Applies the operations of one RFC 6902 patch to `target`. The JSON Pointers of errors are into the patch.
class Operations {
 public:
  Operations(json& target, const PatchLimits& limits) : target_(target), limits_(limits) {}

  Status apply(const json& operation, std::size_t index) {
    where_ = "/patch/" + std::to_string(index);
    if (!operation.is_object()) return problem("", compact(operation), "an object with \"op\" and \"path\"");
    const Result<std::string> op = text(operation, "op");
    if (!op) return op.error();
    const Result<Tokens> path = pointer(operation, "path");
    if (!path) return path.error();
    if (*op == "remove") return remove(*path, "/path");
    if (*op == "move" || *op == "copy") return transfer(operation, *op == "move", *path);
    if (*op != "add" && *op != "replace" && *op != "test")
      return problem("/op", compact(*op),
                     "one of \"add\", \"remove\", \"replace\", \"move\", \"copy\", \"test\"");
    if (!operation.contains("value")) return problem("/value", "nothing", "any JSON value");
    const json& value = operation["value"];
    if (*op == "add") return add(*path, value);
    json* found = find(*path);
    if (!found) return missing("/path", *path);
    if (*op == "replace") return replace(*found, value, path->size());
    if (*found != value)
      return problem("/value", "a scene that has " + compact(*found) + " there", compact(value));
    return ok();
  }

 private:
  Error problem(const std::string& at, std::string found, std::string allowed) const {
    return Error{where_ + at, std::move(found), std::move(allowed)};
  }

  static std::string joined(const Tokens& tokens) {
    std::string text;
    for (const std::string& token : tokens) text.append("/").append(escape_token(token));
    return text;
  }

  Error missing(const std::string& at, const Tokens& tokens) const {
    return problem(at, compact(joined(tokens)), "a JSON Pointer to a value that exists");
  }

  Result<std::string> text(const json& operation, const std::string& key) const {
    const auto found = operation.find(key);
    if (found != operation.end() && found->is_string()) return found->get<std::string>();
    return problem("/" + key, found == operation.end() ? "nothing" : compact(*found), "a text");
  }

  Result<Tokens> pointer(const json& operation, const std::string& key) const {
    const Result<std::string> path = text(operation, key);
    if (!path) return path.error();
    std::optional<Tokens> tokens = split_pointer(*path);
    if (!tokens) return problem("/" + key, compact(*path), "a JSON Pointer such as \"/solver/dt\"");
    return std::move(*tokens);
  }

  json* find(const Tokens& tokens, std::size_t count) const {
    json* at = &target_;
    for (std::size_t i = 0; at && i < count; ++i) at = child(*at, tokens[i]);
    return at;
  }
  json* find(const Tokens& tokens) const { return find(tokens, tokens.size()); }

  Status too_deep() const {
    return problem("/path", "a value nested too deep",
                   "at most " + std::to_string(max_json_depth) + " levels");
  }
  static bool fits(const json& value, std::size_t level) {
    return level + static_cast<std::size_t>(depth(value)) <= max_json_depth;
  }

  Status replace(json& found, json value, std::size_t level) const {
    if (!fits(value, level)) return too_deep();
    found = std::move(value);
    return ok();
  }

  Status add(const Tokens& path, json value) {
    if (!fits(value, path.size())) return too_deep();
    if (path.empty()) return replace(target_, std::move(value), 0);
    json* parent = find(path, path.size() - 1);
    const std::string& last = path.back();
    if (parent && parent->is_object()) {
      (*parent)[last] = std::move(value);
      return ok();
    }
    if (!parent || !parent->is_array())
      return problem("/path", compact(joined(path)), "a place in an object or an array");
    const auto index = last == "-" ? std::optional(parent->size()) : array_index(last, parent->size() + 1);
    if (!index)
      return problem("/path", compact(joined(path)),
                     "an index up to " + std::to_string(parent->size()) + ", or -");
    if (const Status little = count_shifted(parent->size() - *index); !little) return little;
    parent->insert(parent->begin() + static_cast<std::ptrdiff_t>(*index), std::move(value));
    return ok();
  }

  Status remove(const Tokens& path, const std::string& at) {
    if (path.empty()) return problem(at, "the whole scene", "a part of it");
    if (!find(path)) return missing(at, path);
    json& parent = *find(path, path.size() - 1);
    if (parent.is_object()) {
      parent.erase(path.back());
      return ok();
    }
    const std::size_t index = *array_index(path.back(), parent.size());
    if (const Status little = count_shifted(parent.size() - index); !little) return little;
    parent.erase(index);
    return ok();
  }

  Status transfer(const json& operation, bool move, const Tokens& path) {
    const Result<Tokens> from = pointer(operation, "from");
    if (!from) return from.error();
    json* source = find(*from);
    if (!source) return missing("/from", *from);
    if (move && path == *from) return ok();
    if (move && from->size() < path.size() && std::equal(from->begin(), from->end(), path.begin()))
      return problem("/from", compact(joined(*from)), "a value that does not contain the place it moves to");
    if (const Status little = move ? count_moved(*source) : count_copied(*source); !little) return little;
    json value = move ? std::move(*source) : *source;
    if (move) {
      const Status removed = remove(*from, "/from");
      if (!removed) return removed;
    }
    return add(path, std::move(value));
  }

  Status too_much(const char* of_what, std::size_t most, const char* unit) const {
    return problem("", std::string(of_what) + " of more than " + std::to_string(most) + " " + unit,
                   "fewer in one patch");
  }

  Status count_moved(const json& source) {
    moved_ += value_count(source);
    return moved_ > limits_.moved_values ? too_much("moves", limits_.moved_values, "values") : ok();
  }

  Status count_shifted(std::size_t count) {
    shifted_ += count;
    return shifted_ > limits_.shifted_values ? too_much("shifts", limits_.shifted_values, "values of lists")
                                             : ok();
  }

  Status count_copied(const json& source) {
    copied_ += value_count(source);
    if (copied_ > limits_.copied_values) return too_much("copies", limits_.copied_values, "values");
    copied_bytes_ += json_bytes(source);
    return copied_bytes_ > limits_.copied_bytes ? too_much("copies", limits_.copied_bytes, "bytes of JSON")
                                                : ok();
  }

  json& target_;
  const PatchLimits& limits_;
  std::string where_;
  std::size_t copied_ = 0, copied_bytes_ = 0, moved_ = 0, shifted_ = 0;
};

}  // namespace

Status check_bytes(const json& document) {
  const std::size_t bytes = json_bytes(document);
  if (bytes <= max_document_bytes) return ok();
  return Error{"", "a scene of " + std::to_string(bytes) + " bytes of JSON, with its defaults",
               "at most " + std::to_string(max_document_bytes) +
                   " where it is served; keep large meshes in .obj or .ply files that the scene names, or "
                   "use fewer cloths, pins and weights"};
}

Result<json> patched(json target, const json& patch, const PatchLimits& limits) {
  if (patch.is_object()) {
    target.merge_patch(patch);
    return target;
  }
  if (!patch.is_array())
    return Error{"/patch", compact(patch), "an object (RFC 7396 merge patch) or an array (RFC 6902 patch)"};
  if (patch.size() > max_patch_operations)
    return Error{"/patch", std::to_string(patch.size()) + " operations",
                 "at most " + std::to_string(max_patch_operations)};
  Operations operations(target, limits);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const Status done = operations.apply(patch[i], i);
    if (!done) return done.error();
  }
  return target;
}

Result<Document> apply_patch(const Document& document, const json& patch) {
  Result<json> target = patched(document.value, patch);
  if (!target) return target.error();
  give_way_to_fabrics(document.value, *target);
  return validate(std::move(*target), document.assets);
}

}  // namespace clothlab::scene
