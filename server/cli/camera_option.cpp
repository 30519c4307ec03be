#include "server/cli/camera_option.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "server/scene/ranges.h"
#include "server/scene/solid.h"

namespace clothlab::cli {

namespace {

constexpr float widest_angle = 150;  // [degrees]; wider ones show little but their edges

/// Numbers with commas between them. Empty: it is something else.
std::vector<float> numbers_in(const std::string& text) {
  std::vector<float> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    float number = 0;
    const auto [after, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return {};
    numbers.push_back(number);
    if (after == end) return numbers;
    if (*after != ',') return {};
    at = after + 1;
  }
}

Status read_angle(const std::string& part, const std::vector<float>& numbers, CameraChoice& camera) {
  if (numbers.size() != 1 || !(numbers[0] > 0 && numbers[0] <= widest_angle))
    return Error{"--camera", "\"" + part + "\"",
                 "angle=A with more than 0 and at most 150 degrees from the lower to the upper edge"};
  camera.view.angle = numbers[0];
  return ok();
}

Status read_place(const std::string& part, const std::vector<float>& numbers,
                  std::optional<glm::vec3>& place) {
  const bool in_range = std::all_of(numbers.begin(), numbers.end(), [](float number) {
    return number >= scene::ranges::position.minimum && number <= scene::ranges::position.maximum;
  });
  if (numbers.size() != 3 || !in_range)
    return Error{"--camera", "\"" + part + "\"",
                 "three numbers from -1e6 to 1e6 [m] with commas between, e.g. from=2,1,3"};
  place = glm::vec3(numbers[0], numbers[1], numbers[2]);
  return ok();
}

Status read_part(const std::string& part, CameraChoice& camera) {
  const std::size_t equals = part.find('=');
  const std::string key = part.substr(0, equals);
  const bool placed = key == "from" || key == "to";
  if (equals != std::string::npos && (placed || key == "angle")) {
    const std::vector<float> numbers = numbers_in(part.substr(equals + 1));
    if (!placed) return read_angle(part, numbers, camera);
    return read_place(part, numbers, key == "from" ? camera.view.from : camera.view.to);
  }
  // A name may have a ';' of its own.
  camera.subject = camera.subject ? *camera.subject + ';' + part : part;
  return ok();
}

}  // namespace

void add_camera(CLI::App& command, std::optional<std::string>& camera) {
  command
      .add_option(
          "--camera", camera,
          "the name of a cloth or a body, which fills the picture; where the camera stands and what it "
          "looks to [m]; the angle from the lower to the upper edge [degrees]; each may be left out")
      ->type_name("NAME;from=X,Y,Z;to=X,Y,Z;angle=A");
}

Result<CameraChoice> parse_camera(const std::string& text) {
  CameraChoice camera;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    if (Status read = read_part(text.substr(at, end - at), camera); !read) return read.error();
    at = end + 1;
  }
  const auto& [from, to, angle] = camera.view;
  if (from && to && *from == *to)
    return Error{"--camera", "\"" + text + "\"",
                 "two places for from and to: it looks from one to the other"};
  return camera;
}

Status check_subject(const CameraChoice& camera, const scene::Scene& scene) {
  if (!camera.subject) return ok();
  std::string names;
  bool found = false;
  const auto see = [&](const std::string& name) {
    names += (names.empty() ? "\"" : ", \"") + name + '"';
    found |= name == *camera.subject;
  };
  for (const scene::Cloth& cloth : scene.cloths) see(cloth.name);
  for (const scene::Collider& collider : scene.colliders)
    if (std::isfinite(scene::bounds(collider.shape).radius)) see(collider.name);
  if (found) return ok();
  return Error{"--camera", "\"" + *camera.subject + "\"",
               "the name of a cloth or a finite body (" + names + "), or from=X,Y,Z, to=X,Y,Z, angle=A"};
}

}  // namespace clothlab::cli
