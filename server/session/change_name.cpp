#include "server/session/change_name.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace clothlab::session {

namespace {

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string title_of(const std::string& key) {
  if (key == "dt") return "Time step";
  if (key == "self_collision") return "Self-collision";
  std::string text = words(key);
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string name_of(const json& item) {
  return item.is_object() ? item.value("name", std::string("?")) : "?";
}

const json& at(const json& object, const std::string& key) {
  static const json nothing = nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

/// Finds the places, from the whole document down to two levels below a cloth or a collider.
class Comparison {
 public:
  std::vector<std::string> places;

  void scenes(const json& before, const json& after) {
    each_difference(before, after, [&](const std::string& key, const json& was, const json& is) {
      if ((key == "cloths" || key == "colliders") && was.is_array() && is.is_array())
        lists(title_of(key), was, is);
      else if (key == "solver")
        each_difference(was, is,
                        [&](const std::string& of, const json&, const json&) { note(title_of(of)); });
      else
        members(title_of(key), was, is);
    });
  }

 private:
  template <class Each>
  void each_difference(const json& before, const json& after, Each each) {
    std::set<std::string> keys;
    for (const auto& [key, value] : before.items()) keys.insert(key);
    for (const auto& [key, value] : after.items()) keys.insert(key);
    for (const std::string& key : keys)
      if (at(before, key) != at(after, key)) each(key, at(before, key), at(after, key));
  }

  void members(const std::string& of, const json& before, const json& after) {
    if (!before.is_object() || !after.is_object()) return note(of);
    each_difference(before, after,
                    [&](const std::string& key, const json&, const json&) { note(of + ": " + words(key)); });
  }

  void lists(const std::string& what, const json& before, const json& after) {
    if (before.size() == after.size()) {
      for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i] != after[i]) item(before[i], after[i]);
      return;
    }
    const std::size_t noted = places.size();
    for (const json& is : after)
      if (const json* was = named(before, name_of(is)); !was)
        note("Add " + name_of(is));
      else if (*was != is)
        item(*was, is);
    for (const json& was : before)
      if (!named(after, name_of(was))) note("Remove " + name_of(was));
    if (places.size() == noted) note(what);
  }

  static const json* named(const json& list, const std::string& name) {
    for (const json& item : list)
      if (name_of(item) == name) return &item;
    return nullptr;
  }

  void item(const json& before, const json& after) {
    const std::string name = name_of(after);
    each_difference(before, after, [&](const std::string& key, const json& was, const json& is) {
      if (key == "name")
        note("Rename " + name);
      else if (key == "pins")
        pins(name, was, is);
      else
        members(members_name(name, key, was, is), was, is);
    });
  }

  /// What is an object before and after is told by its members alone.
  static std::string members_name(const std::string& name, const std::string& key, const json& was,
                                  const json& is) {
    return was.is_object() && is.is_object() ? name : name + ": " + words(key);
  }

  void pins(const std::string& name, const json& before, const json& after) {
    if (after.size() < before.size()) return note("Take a pin off");
    if (after.size() == before.size()) return note(name + ": pins");
    const json& last = at(after.back(), "at");
    const bool vertex = last.is_string() && last.get_ref<const std::string&>().starts_with("vertex:");
    note(vertex ? "Pin a vertex" : name + ": pins");
  }

  void note(std::string place) {
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(std::move(place));
  }
};

}  // namespace

std::vector<std::string> changed_places(const json& before, const json& after) {
  Comparison comparison;
  comparison.scenes(before, after);
  return std::move(comparison.places);
}

std::string shortened(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  const std::string rest = "…";
  std::size_t end = most - rest.size();
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text + rest;
}

std::string change_name(const std::vector<std::string>& places) {
  if (places.empty()) return "Nothing";
  std::string name = places[0];
  if (places.size() == 2) name += ", " + places[1];
  if (places.size() <= 2) return shortened(std::move(name), max_change_name_bytes);
  const std::string rest = " and " + std::to_string(places.size() - 1) + " more";
  return shortened(std::move(name), max_change_name_bytes - rest.size()) + rest;
}

}  // namespace clothlab::session
