// scene.*: read, replace and patch the document, undo and redo: the session's thread validates the request
// and answers. scene.presets lists the presets and the fabrics without the session.
#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/fabrics.h"
#include "server/session/change_name.h"

namespace clothlab::net {

namespace {

std::optional<std::uint64_t> read_revision(Params& params) {
  constexpr std::int64_t most = (std::int64_t{1} << 53) - 1;  // JSON numbers are exact up to here
  const std::int64_t revision = params.integer("revision", 0, most, -1);
  return revision < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(revision));
}

Outcome travel(Client& client, Request& request, session::Direction direction) {
  Params params(request.params);
  const session::TravelHistory travel{direction, read_revision(params)};
  if (auto error = params.check()) return *error;
  return ask_session(client, request, travel);
}

}  // namespace

Outcome scene_get(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  const bool is_long = client.room()->scene_bytes() > max_answers_ahead_bytes;
  return (is_long ? ask_at_length : ask_session)(client, request, session::GetScene{});
}

Outcome scene_load(Client& client, Request& request) {
  Params params(request.params);
  session::LoadScene load{params.text("preset", ""), nullptr};
  if (params.has("preset") == params.has("scene"))
    params.refuse("preset", "either a preset's name, or a scene");
  else if (params.has("preset") && load.preset.empty())
    params.refuse("preset", "a preset's name, see scene.presets");
  (void)params.value("scene");
  if (auto error = params.check()) return *error;
  if (params.has("scene")) load.document = std::move(request.params["scene"]);
  return ask_session(client, request, std::move(load));
}

Outcome scene_patch(Client& client, Request& request) {
  Params params(request.params);
  session::PatchScene patch;
  if (const json& value = params.value("patch"); !value.is_object() && !value.is_array())
    params.refuse("patch", "an object (RFC 7396 merge patch) or an array (RFC 6902 patch)");
  patch.revision = read_revision(params);
  patch.name = params.label("name", session::max_change_name_bytes, "");
  patch.keep_stable = params.flag("keep_stable");
  if (auto error = params.check()) return *error;
  patch.patch = std::move(request.params["patch"]);
  return ask_session(client, request, std::move(patch));
}

Outcome scene_undo(Client& client, Request& request) {
  return travel(client, request, session::Direction::undo);
}
Outcome scene_redo(Client& client, Request& request) {
  return travel(client, request, session::Direction::redo);
}

Outcome scene_presets(Client&, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  json fabrics = json::array();
  if (const auto& all = scene::fabrics())
    for (const scene::Fabric& fabric : *all)
      fabrics.push_back({{"name", fabric.name}, {"feel", fabric.feel}, {"source", fabric.source}});
  json about = json::object();
  for (const scene::Preset& preset : scene::presets()) about[preset.name] = preset.description;
  return json{
      {"presets", scene::preset_names()}, {"about", std::move(about)}, {"fabrics", std::move(fabrics)}};
}

}  // namespace clothlab::net
