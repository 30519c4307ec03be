// mesh.upload, as a session's thread carries it out.
#include <set>

#include "server/base/base64.h"
#include "server/session/change_name.h"
#include "server/session/mesh_facts.h"
#include "server/session/stepper.h"

namespace clothlab::session {

namespace {

/// The names of the meshes that the cloths and colliders of a document have.
std::set<std::string> mesh_names(const json& document) {
  std::set<std::string> names;
  for (const char* list : {"cloths", "colliders"})
    for (const json& item : document[list])
      for (const char* key : {"file", "obj"})
        if (item.contains("mesh") && item["mesh"].contains(key))
          names.insert(item["mesh"][key].get<std::string>());
  return names;
}

/// An upload that replaces a mesh of the scene changes no word of the document.
History::Change replacement(History::MeshChange mesh, std::uint64_t by) {
  History::Change change;
  change.name = change.places = shortened("Replace mesh " + mesh.name, max_change_name_bytes);
  change.by = by;
  change.back = change.forth = "[]";
  change.mesh = std::move(mesh);
  return change;
}

}  // namespace

std::set<std::string> Stepper::meshes_named() const {
  return mesh_names(document_.value);
}

void Stepper::keep_mesh(const std::string& name) {
  if (const clothlab::Status kept = meshes_->keep(name); !kept)
    exchange_.emit(Notice{"error", "the mesh " + name + " cannot be saved: " + kept.error().what +
                                       "; it would be lost with the server"});
}

void Stepper::perform(UploadMesh& upload, const Ticket& ticket) {
  if (upload.in_base64) {
    std::optional<std::string> decoded = from_base64(upload.bytes);
    if (!decoded)
      return reply(ticket, invalid_value({"/obj", "text that is not base64", "base64 (RFC 4648), padded"}));
    upload.bytes = std::move(*decoded);
  }
  const std::size_t bytes = upload.bytes.size();
  const Result<MeshShelf::SharedItem> item = meshes_->read(upload.name, std::move(upload.bytes));
  upload.in_hand.reset();
  if (!item)
    return reply(ticket,
                 invalid_value({"/obj", item.error().where + ": " + item.error().what, item.error().remedy}));
  const std::set<std::string> named = meshes_named();
  const Result<std::vector<std::string>> removed = meshes_->make_place(upload.name, bytes, named);
  if (!removed) return reply(ticket, Refusal{Refusal::Reason::over_limit, removed.error()});
  MeshShelf::SharedItem before = meshes_->exchange(upload.name, *item);
  if (named.contains(upload.name)) {
    if (const clothlab::Status used = use_again(upload.name, ticket); !used) {
      meshes_->exchange(upload.name, std::move(before));
      return reply(ticket, refused(used.error()));
    }
    remember(replacement({upload.name, std::move(before), *item}, ticket.asker));
  }
  keep_mesh(upload.name);
  json answer = mesh_facts(upload.name, *(*item)->mesh, *meshes_, bytes);
  answer["removed"] = *removed;
  reply(ticket, std::move(answer));
}

/// The scene has a mesh of which another version has come: the cloth is built anew.
clothlab::Status Stepper::use_again(const std::string& mesh, const Ticket& ticket) {
  Result<scene::Document> document = scene::validate(document_.value, meshes_);
  if (!document) return document.error();
  under_way_.name = "Replace mesh " + mesh;
  const Result<sim::ChangeDepth> depth = built([&] { return engine_for(*document, false); });
  if (!depth) return depth.error();
  adopt(std::move(*document), *depth);
  announce_scene(std::nullopt, ticket.asker);
  exchange_.emit(Notice{"info", "the mesh " + mesh + " was replaced: time starts again at 0"});
  return ok();
}

}  // namespace clothlab::session
