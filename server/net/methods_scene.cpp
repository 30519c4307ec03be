// scene.*: read, replace and patch the document: the session's thread validates the request and answers.
// scene.presets lists the presets and the fabrics without the session.
#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/fabrics.h"

namespace clothlab::net {

Outcome scene_get(Client& client, const Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, session::GetScene{});
}

Outcome scene_load(Client& client, const Request& request) {
  Params params(request.params);
  session::LoadScene load{params.text("preset", ""), params.value("scene")};
  if (params.has("preset") == params.has("scene"))
    params.refuse("preset", "either a preset's name, or a scene");
  else if (params.has("preset") && load.preset.empty())
    params.refuse("preset", "a preset's name, see scene.presets");
  if (auto error = params.check()) return *error;
  return ask_session(client, request, std::move(load));
}

Outcome scene_patch(Client& client, const Request& request) {
  Params params(request.params);
  session::PatchScene patch{params.value("patch"), std::nullopt};
  if (!patch.patch.is_object() && !patch.patch.is_array())
    params.refuse("patch", "an object (RFC 7396 merge patch) or an array (RFC 6902 patch)");
  constexpr std::int64_t most = (std::int64_t{1} << 53) - 1;  // JSON numbers are exact up to here
  const std::int64_t revision = params.integer("revision", 0, most, -1);
  if (auto error = params.check()) return *error;
  if (revision >= 0) patch.revision = static_cast<std::uint64_t>(revision);
  return ask_session(client, request, std::move(patch));
}

Outcome scene_presets(Client&, const Request& request) {
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
