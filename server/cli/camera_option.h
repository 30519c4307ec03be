// What `--camera` says: what fills a picture, and where the camera is.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/render/camera.h"
#include "server/scene/scene.h"

namespace clothlab::cli {

struct CameraChoice {
  std::optional<std::string> subject;  ///< a name; none: all of the scene
  render::View view;
};

/// Adds `--camera`.
void add_camera(CLI::App& command, std::optional<std::string>& camera);
/// Parts with ';' between them: from=X,Y,Z, to=X,Y,Z, angle=A, and whatever else is a name.
Result<CameraChoice> parse_camera(const std::string& text);
/// Error: nothing of the scene that fits into a picture has the name of the camera's subject.
Status check_subject(const CameraChoice& camera, const scene::Scene& scene);

}  // namespace clothlab::cli
