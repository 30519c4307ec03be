#include "server/session/history.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "server/scene/document.h"
#include "server/session/change_name.h"

namespace clothlab::session {

namespace {

/// The shorter way from one document to another: a patch that clients take, or the document itself.
std::string way(const json& patch, const json& to) {
  std::string document = to.dump();
  if (patch.size() > scene::max_patch_operations) return document;
  std::string text = patch.dump();
  return text.size() < document.size() ? text : document;
}

bool replaces_values_only(const json& patch) {
  return std::all_of(patch.begin(), patch.end(), [](const json& operation) {
    return operation["op"] == "replace" && !operation["value"].is_structured();
  });
}

/// The document that a way leads to.
Result<json> walked(const std::string& way, const json& from) {
  try {
    json step = json::parse(way);
    return step.is_array() ? from.patch(step) : step;
  } catch (const json::exception& problem) {
    return Error{"history", problem.what(), "change the scene by hand; please report it"};
  }
}

std::size_t bytes_of(const MeshShelf::SharedItem& item) {
  if (!item) return 0;
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  const mesh::Mesh& mesh = *item->mesh;
  return item->bytes.capacity() + of(mesh.vertices) + of(mesh.triangles) + of(mesh.texture) +
         of(mesh.vertex_of) + of(mesh.face_line);
}

std::string joined(const std::vector<std::string>& places) {
  std::string text;
  for (const std::string& place : places) text += place + "\n";
  return text;
}

}  // namespace

std::size_t History::Change::bytes() const {
  const std::size_t meshes = mesh ? bytes_of(mesh->before) + bytes_of(mesh->after) : 0;
  return sizeof *this + name.capacity() + places.capacity() + back.capacity() + forth.capacity() + meshes;
}

History::Change History::prepare(const json& before, const json& after, std::string name, std::uint64_t by,
                                 Clock::time_point now) const {
  const std::vector<std::string> places = changed_places(before, after);
  Change change;
  change.name = name.empty() ? change_name(places) : std::move(name);
  change.by = by;
  change.at = now;
  change.places = joined(places);
  if (places.empty()) return change;
  const json forth = json::diff(before, after);
  change.values_only = replaces_values_only(forth);
  change.forth = way(forth, after);
  change.back = way(json::diff(after, before), before);
  if (!further_part(change)) return change;
  const Result<json> first = target(Direction::undo, before);
  if (!first) return change;
  change.continues = true;
  change.forth = way(json::diff(*first, after), after);
  change.back = way(json::diff(after, *first), *first);
  if (*first == after) change.places.clear();
  return change;
}

bool History::further_part(const Change& change) const {
  if (!open_ || done_ == 0 || done_ != changes_.size()) return false;
  const Change& last = changes_.back();
  return last.values_only && change.values_only && last.by == change.by && last.name == change.name &&
         last.places == change.places && change.at - last.at <= one_change;
}

void History::add(Change change) {
  if (change.continues) {
    changes_.pop_back();
    --done_;
  } else if (change.places.empty()) {
    return;
  }
  open_ = !change.places.empty();
  if (!open_) return;
  for (std::string* text : {&change.places, &change.back, &change.forth}) text->shrink_to_fit();
  last_ = Last{"change", change.name, change.by};
  changes_.resize(done_);
  changes_.push_back(std::move(change));
  ++done_;
  forget_oldest();
}

void History::forget_oldest() {
  std::size_t bytes = 0;
  for (const Change& change : changes_) bytes += change.bytes();
  while (!changes_.empty() && (changes_.size() > max_changes || bytes > most_)) {
    bytes -= changes_.front().bytes();
    changes_.pop_front();
    --done_;
  }
}

const History::Change* History::next(Direction direction) const {
  if (direction == Direction::undo) return done_ > 0 ? &changes_[done_ - 1] : nullptr;
  return done_ < changes_.size() ? &changes_[done_] : nullptr;
}

Result<json> History::target(Direction direction, const json& present) const {
  const Change& change = *next(direction);
  return walked(direction == Direction::undo ? change.back : change.forth, present);
}

void History::moved(Direction direction, std::uint64_t by) {
  const bool undo = direction == Direction::undo;
  last_ = Last{undo ? "undo" : "redo", next(direction)->name, by};
  done_ = undo ? done_ - 1 : done_ + 1;
  open_ = false;
}

json History::told() const {
  json told{{"undos", done_}, {"redos", changes_.size() - done_}, {"last", nullptr}};
  const auto tell = [&](const char* key, const Change* change) {
    told[key] = change ? json(change->name) : json(nullptr);
    told[std::string(key) + "_by"] = change ? json(change->by) : json(nullptr);
  };
  tell("undo", next(Direction::undo));
  tell("redo", next(Direction::redo));
  if (last_) told["last"] = {{"what", last_->what}, {"name", last_->name}, {"by", last_->by}};
  return told;
}

}  // namespace clothlab::session
