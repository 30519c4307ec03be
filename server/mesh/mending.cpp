#include "server/mesh/mending.h"

#include <utility>

namespace clothlab::mesh {

namespace {

constexpr std::size_t most_places = 5;

struct Words {
  const char *one, *many;
};

Words words_of(Fault fault) {
  switch (fault) {
    case Fault::word:
      return {"line with a word that is none of this format was left out",
              "lines with words that are none of this format were left out"};
    case Fault::vertex:
      return {"vertex without a place was left out, and its faces",
              "vertices without a place were left out, and their faces"};
    case Fault::texture:
      return {"line of texture coordinates without numbers was taken for 0 0",
              "lines of texture coordinates without numbers were taken for 0 0"};
    case Fault::face:
      return {"face that cannot be read was left out", "faces that cannot be read were left out"};
    case Fault::curve:
      return {"line of a curved surface was left out", "lines of curved surfaces were left out"};
    case Fault::no_area:
      return {"face without area was left out", "faces without area were left out"};
    case Fault::corner_twice:
      return {"face has a corner twice, of which one was left out",
              "faces have a corner twice, of which one was left out"};
    case Fault::folded:
      return {"polygon crosses itself or is folded flat, and was cut into triangles all the same",
              "polygons cross themselves or are folded flat, and were cut into triangles all the same"};
    case Fault::doubled:
      return {"triangle is there already and was left out", "triangles are there already and were left out"};
    case Fault::strip:
      return {"strip was cut into its triangles", "strips were cut into their triangles"};
    case Fault::on_edge:
      return {"corner lies on an edge that has no vertex there: the edge was divided",
              "corners lie on an edge that has no vertex there: the edges were divided"};
    case Fault::welded:
      return {"vertex within a micrometre of another one was joined with it",
              "vertices within a micrometre of another one were joined with it"};
    case Fault::unused:
      return {"vertex of no face was left out", "vertices of no face were left out"};
    case Fault::one_sided:
      return {"edge joins a surface with one side only, like a Moebius band, and has two outsides",
              "edges join a surface with one side only, like a Moebius band, and have two outsides"};
  }
  return {"", ""};
}

}  // namespace

void Mending::add(Fault fault, std::string place) {
  Found& found = found_[static_cast<std::size_t>(fault)];
  if (found.count++ < most_places) found.places.push_back(std::move(place));
}

std::vector<std::string> Mending::notes() const {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < faults; ++i) {
    const Found& found = found_[i];
    if (found.count == 0) continue;
    const Words words = words_of(static_cast<Fault>(i));
    std::string note = std::to_string(found.count) + " " + (found.count == 1 ? words.one : words.many);
    const char* before = ": ";
    for (const std::string& place : found.places) note += std::exchange(before, ", ") + place;
    if (found.count > found.places.size()) note += ", ...";
    notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace clothlab::mesh
