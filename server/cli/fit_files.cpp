#include "server/cli/fit_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/common.hpp>
#include <limits>
#include <set>

#include "server/base/files.h"
#include "server/base/text.h"
#include "server/model/model.h"
#include "server/model/remedy.h"
#include "server/model/thickness.h"
#include "server/scene/document.h"
#include "server/scene/mesh_notes.h"
#include "server/scene/method.h"

namespace clothlab::cli {

namespace {

namespace fs = std::filesystem;
using glm::dvec3;
using scene::json;

// Contact keeps surfaces a tenth of an edge apart, within what cloth and the air between its layers measure
// [m].
constexpr double thickness_over_edge = 0.1, least_thickness = 1e-4, most_thickness = 3e-3;
constexpr double friction = 0.3;                // cotton on skin or cotton: 0.2 to 0.5
constexpr double seconds_of_leading_out = 1.0;  // 500 steps: 125 edges
constexpr double held_share = 0.03;  // of the height, at the top, where nothing else carries the cloth

struct Box {
  dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void take(const mesh::Mesh& mesh) {
    for (const dvec3& vertex : mesh.vertices) {
      low = glm::min(low, vertex);
      high = glm::max(high, vertex);
    }
  }
  double size() const {
    const dvec3 sides = high - low;
    return std::max({sides.x, sides.y, sides.z});
  }
};

class Fitting {
 public:
  explicit Fitting(const FitRequest& request)
      : request_(request),
        root_(fs::path(request.out).parent_path().empty() ? fs::path(".")
                                                          : fs::path(request.out).parent_path()),
        assets_(std::make_shared<scene::FolderAssets>(root_)) {}

  Result<std::vector<std::string>> run() {
    document_ = {{"version", 1}, {"name", name_of(request_.out)}, {"cloths", json::array()}};
    for (const bool body : {false, true})
      for (const std::string& file : body ? request_.bodies : request_.cloths)
        if (const Status added = add(file, body); !added) return added.error();
    choose_unit();
    if (request_.bodies.empty()) hold_top();
    if (const Status chosen = choose_steps(); !chosen) return chosen.error();
    Result<scene::Document> whole = scene::validate(document_, assets_);
    if (!whole) return whole.error();
    Result<model::Model> model = model::build(whole->scene);
    if (!model && model.error().facts.find("crossings") != std::string::npos) {
      lead_out();
      whole = scene::validate(document_, assets_);
      if (!whole) return whole.error();
      model = model::build(whole->scene);
    }
    if (!model) return model.error();
    if (const Status written = replace_file(request_.out, document_.dump(2) + "\n"); !written)
      return written.error();
    return std::move(chosen_);
  }

 private:
  /// Its name without folder and ending, as a name in a scene may be.
  std::string name_of(const std::string& file) {
    constexpr std::size_t longest = 60;
    std::string name = fs::path(file).stem().string().substr(0, longest);
    if (name.empty()) name = "scene";
    const std::string first = name;
    for (int number = 2; !names_.insert(name).second; ++number) name = first + "-" + std::to_string(number);
    return name;
  }

  Status add(const std::string& file, bool body) {
    std::error_code failure;
    if (!fs::exists(file, failure)) return Error{file, "no such file", "check the name and the folder"};
    const fs::path below = fs::relative(file, root_, failure);
    if (failure || below.empty() || *below.begin() == "..")
      return Error{file, "does not lie below the folder of " + request_.out,
                   "a scene's file in a folder above its meshes"};
    const std::string name = below.generic_string();
    const Result<scene::SharedMesh> mesh = assets_->mesh(name, {});
    if (!mesh) return mesh.error();
    if (!body && (*mesh)->no_cloth) return *(*mesh)->no_cloth;
    all_.take(**mesh);
    if (!body) cloths_.take(**mesh);
    json item = {{"name", name_of(file)}, {"mesh", {{"file", name}}}};
    if (body)
      item["friction"] = friction;
    else
      item["material"] = {{"fabric", request_.fabric}};
    document_[body ? "colliders" : "cloths"].push_back(std::move(item));
    return ok();
  }

  /// All files have the same: a garment and its body were made together.
  void choose_unit() {
    const double size = all_.size();
    if (const std::optional<double> factor = scene::unit_factor(size)) scale_ = *factor;
    if (scale_ == 1.0) {
      chosen_.push_back("the files are taken to be in metres: all of them measure " +
                        with_significant_digits(size, 3) + " m");
      return;
    }
    for (const char* list : {"cloths", "colliders"})
      if (document_.contains(list))
        for (json& item : document_[list]) item["transform"] = {{"scale", scale_}};
    chosen_.push_back("the files are taken to be in another unit: scaled by " +
                      with_significant_digits(scale_, 4) + " all of them measure " +
                      with_significant_digits(size * scale_, 3) + " m");
  }

  void lead_out() {
    for (json& cloth : document_["cloths"]) cloth["start"] = {{"dress", seconds_of_leading_out}};
    chosen_.push_back("the files have cloth that goes through a body or itself: it is led out at the start");
  }

  void hold_top() {
    const dvec3 low = scale_ * cloths_.low, high = scale_ * cloths_.high;
    const double height = high.y - low.y, all = 2.0 * scale_ * cloths_.size();
    const json box = {{low.x - all, high.y - held_share * height - 1e-6, low.z - all},
                      {high.x + all, high.y + all, high.z + all}};
    for (json& cloth : document_["cloths"]) {
      const std::size_t i = static_cast<std::size_t>(&cloth - &document_["cloths"][0]);
      if (reaches(i, high.y - held_share * height)) cloth["pins"] = {{{"at", {{"box", box}}}}};
    }
    chosen_.push_back("nothing carries the cloth: its highest 3 % are held");
  }

  /// True if the cloth of this number has a vertex at this height or above [m].
  bool reaches(std::size_t cloth, double height) const {
    const std::string name = document_["cloths"][cloth]["mesh"]["file"].get<std::string>();
    const Result<scene::SharedMesh> mesh = assets_->mesh(name, {});
    return mesh && std::any_of((*mesh)->vertices.begin(), (*mesh)->vertices.end(),
                               [&](const dvec3& vertex) { return scale_ * vertex.y >= height; });
  }

  /// Contact, and a solver under which the cloth alone holds.
  Status choose_steps() {
    json alone = document_;
    alone.erase("colliders");
    const Result<scene::Document> cloth = scene::validate(alone, assets_);
    if (!cloth) return cloth.error();
    const Result<model::Model> model = model::build(cloth->scene);
    if (!model) return model.error();
    if (!request_.bodies.empty() || request_.cloths.size() > 1) {
      const double edge = model::least_mean_edge(*model);
      const double thickness = std::stod(
          formatted("%.2g", std::clamp(thickness_over_edge * edge, least_thickness, most_thickness)));
      document_["self_collision"] = {{"kind", "surface"}, {"thickness", thickness}, {"friction", friction}};
      chosen_.push_back("surfaces keep " + with_significant_digits(1000.0 * thickness, 3) +
                        " mm apart; edges of the mesh measure " + with_significant_digits(1000.0 * edge, 3) +
                        " mm");
    }
    const scene::Solver solver = model::solver_that_holds(*model, cloth->scene);
    document_["solver"] = {{"method", scene::name(solver.method)},
                           {"dt", solver.dt},
                           {"iterations", solver.iterations},
                           {"tolerance", solver.tolerance}};
    chosen_.push_back(request_.fabric + ", stepped by " + scene::name(solver.method) +
                      " with dt = " + with_significant_digits(solver.dt, 3) + " s");
    return ok();
  }

  const FitRequest& request_;
  const fs::path root_;
  const std::shared_ptr<const scene::Assets> assets_;
  json document_;
  Box all_, cloths_;  // in the files' unit
  double scale_ = 1.0;
  std::set<std::string> names_;
  std::vector<std::string> chosen_;
};

}  // namespace

Result<std::vector<std::string>> fit_files(const FitRequest& request) {
  return Fitting(request).run();
}

}  // namespace clothlab::cli
