// `--set /solver/dt=0.0005`: sets one value of the document, which a JSON Pointer names.
#include "server/scene/document.h"
#include "server/scene/named_fabric.h"
#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

const char* const assignment_form = "POINTER=VALUE, e.g. /solver/dt=0.0005 or /cloths/0/texture=checker";

/// Parses the text as JSON. Other text is a plain string, unless it starts like JSON ({, [ or "): then it
/// is an error.
Result<json> parse_value(const std::string& text, const std::string& pointer) {
  Result<json> value = parse_json(text, pointer);
  if (value) return value;
  const std::size_t first = text.find_first_not_of(" \t");
  if (first != std::string::npos && std::string("{[\"").find(text[first]) != std::string::npos) return value;
  return json(text);
}

/// The value that `tokens` name, made if it is absent. Null if an array has no such index or a value on the
/// way is neither object nor array; `reached` is then the index of the token that failed.
json* make_place(json& top, const std::vector<std::string>& tokens, std::size_t& reached) {
  json* at = &top;
  for (reached = 0; reached < tokens.size(); ++reached) {
    const std::string& token = tokens[reached];
    if (at->is_null()) *at = json::object();
    if (at->is_object()) {
      at = &(*at)[token];
    } else if (at->is_array() && (token == "-" || array_index(token, at->size() + 1) == at->size())) {
      at->push_back(nullptr);
      at = &at->back();
    } else if (!(at = child(*at, token))) {
      return nullptr;
    }
  }
  return at;
}

}  // namespace

Result<Document> set_value(const Document& document, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return Error{"--set", compact(assignment), assignment_form};
  const std::string pointer = assignment.substr(0, equals);
  const auto tokens = split_pointer(pointer);
  if (!tokens || tokens->empty() || tokens->size() > max_json_depth)
    return Error{"--set", compact(assignment), assignment_form};

  Result<json> value = parse_value(assignment.substr(equals + 1), pointer);
  if (!value) return value.error();
  json target = document.value;
  std::size_t reached = 0;
  json* place = make_place(target, *tokens, reached);
  if (!place)
    return Error{pointer, "no such place (" + compact((*tokens)[reached]) + ")",
                 "an existing key or index; `-` appends to an array"};
  *place = std::move(*value);
  give_way_to_fabrics(document.value, target);
  return validate(std::move(target), document.assets);
}

}  // namespace clothlab::scene
