#include "server/lab/simplification.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/beside.h"

namespace clothlab::lab {

namespace {

using scene::Document;

constexpr double worth_it = 0.95;  // of the whole's cost: what saves less is not worth a change of the model
constexpr double share_of_truth = 0.4;  // of the job, for its progress

std::string percent(double share) {
  return significant(100.0 * share, 3) + " %";
}

/// "a", "a and b", "a, b and c".
std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

class Maker {
 public:
  Maker(const Document& document, const SimplifyRequest& request, const Control<Simplification>& control)
      : document_(document), request_(request), control_(control), beside_(document, control.stop) {}

  Result<Simplification> make() {
    found_.scene = document_.scene.name;
    found_.renderer = gl::renderer_name();
    found_.tolerance = request_.tolerance;
    found_.setting = setting_of(document_.scene);
    found_.recommended.patch = scene::json::object();
    if (Status measured = measure_whole(); !measured) return measured.error();
    if (found_.whole.measured) {
      if (Status measured = measure_parts(); !measured) return measured.error();
      if (Status recommended = recommend(); !recommended) return recommended.error();
    }
    explain();
    found_.complete = true;
    control_.progress({1.0, 1.0, "done"});
    return found_;
  }

 private:
  Status measure_whole() {
    const auto progress = [this](double share) {
      control_.progress({share_of_truth * share, 1.0, "the reference, in double precision"});
    };
    Status started = beside_.start(request_.time.value_or(1.0), progress, found_.notes);
    if (!started) return started;
    found_.size = beside_.truth().size;
    found_.time = beside_.truth().time;
    found_.horizon = beside_.compared_at();
    found_.whole = beside_.whole().variant;
    control_.arrived(found_);
    return ok();
  }

  Status measure_parts() {
    for (const Part& part : parts()) {
      control_.progress({progress(), 1.0, part.name});
      Candidate candidate;
      candidate.variant.name = part.name;
      candidate.variant.patch = scene::json::object();
      candidate.parts = {&part};
      Result<Document> without = part.without(document_);
      if (!without) {
        candidate.variant.reason = without.error().where.empty()
                                       ? without.error().what
                                       : without.error().where + ": " + without.error().what;
      } else if (Status measured = beside_.measure(candidate, std::move(*without)); !measured) {
        return measured;
      }
      candidates_.push_back(std::move(candidate));
      found_.variants.push_back(candidates_.back().variant);
      control_.arrived(found_);
    }
    std::vector<Candidate*> timed;
    for (Candidate& candidate : candidates_)
      if (candidate.variant.measured) timed.push_back(&candidate);
    control_.progress({progress(), 1.0, "timing, taking turns"});
    if (Status done = beside_.time(timed); !done) return done;
    show();
    return ok();
  }

  bool can_go(const Variant& variant) const {
    return variant.measured && variant.change && *variant.change <= request_.tolerance &&
           variant.cost_ratio <= worth_it;
  }

  Status recommend() {
    std::vector<Candidate*> going;
    Candidate* mesh = nullptr;  // one resolution, the cheapest
    for (Candidate& candidate : candidates_) {
      if (!can_go(candidate.variant)) continue;
      if (!candidate.coarser())
        going.push_back(&candidate);
      else if (!mesh || candidate.variant.cost_ratio < mesh->variant.cost_ratio)
        mesh = &candidate;
    }
    if (mesh) going.push_back(mesh);
    while (!going.empty()) {
      Candidate together;
      if (Status measured = measure_together(going, together); !measured) return measured;
      if (together.variant.change && *together.variant.change <= request_.tolerance) {
        recommended(going, together);
        return ok();
      }
      const auto least =
          std::max_element(going.begin(), going.end(), [](const Candidate* a, const Candidate* b) {
            return a->variant.cost_ratio < b->variant.cost_ratio;
          });
      found_.notes.push_back(
          together.variant.name + ": together they " +
          (together.variant.change ? "change " + percent(*together.variant.change) + " of the size"
                                   : "cannot be had, " + together.variant.reason) +
          ", so \"" + (*least)->variant.name + "\", which saves least, is not recommended.");
      going.erase(least);
    }
    return ok();
  }

  /// What the recommended ones do when all are gone. One alone has been measured.
  Status measure_together(const std::vector<Candidate*>& going, Candidate& together) {
    if (going.size() == 1) {
      together = *going.front();
      return ok();
    }
    std::vector<std::string> names;
    Document document = document_;
    for (const Candidate* candidate : going) {
      names.push_back(candidate->variant.name);
      together.parts.push_back(candidate->parts.front());
      Result<Document> without = candidate->parts.front()->without(document);
      if (!without) return without.error();
      document = std::move(*without);
    }
    together.variant.name = list(names);
    control_.progress({progress(), 1.0, "all that can go, together"});
    if (Status measured = beside_.measure(together, std::move(document)); !measured) return measured;
    return together.variant.measured ? beside_.time({&together}) : ok();
  }

  void recommended(const std::vector<Candidate*>& going, const Candidate& together) {
    for (Candidate* candidate : going) candidate->variant.drop = true;
    show();
    found_.recommended = together.variant;
    found_.recommended.drop = true;
    if (std::any_of(going.begin(), going.end(),
                    [](const Candidate* each) { return each->variant.name == without_damping; }))
      found_.notes.push_back("Damping was judged within " + significant(found_.time, 3) +
                             " s: in the long run it is what brings a cloth to rest.");
  }

  void show() {
    found_.whole = beside_.whole().variant;
    found_.variants.clear();
    for (const Candidate& candidate : candidates_) found_.variants.push_back(candidate.variant);
    control_.arrived(found_);
  }

  double progress() const {
    const double share =
        static_cast<double>(found_.variants.size()) / static_cast<double>(parts().size() + 2);
    return share_of_truth + (1.0 - share_of_truth) * share;
  }

  void explain() {
    const std::string allowed = " (" + percent(request_.tolerance) + " allowed)";
    if (!found_.whole.measured) {
      found_.why = "Nothing was compared, as the scene as it is does not hold: " + found_.whole.reason +
                   ". A stable step comes first.";
    } else if (found_.recommended.drop) {
      const Variant& best = found_.recommended;
      const double dt = best.patch.contains("solver") ? best.patch["solver"]["dt"].get<double>()
                                                      : document_.scene.solver.dt;
      found_.why =
          "The scene can do with this: " + best.name +
          (dt > document_.scene.solver.dt ? ", with a step of " + significant(1000 * dt, 3) + " ms" : "") +
          "; that takes " + significant(best.cost_ratio, 3) + " times the time and changes positions by " +
          percent(*best.change) + " of the size" + allowed + ".";
    } else if (found_.horizon == 0.0) {
      found_.why = std::string("Nothing is recommended, because positions cannot be compared; ") +
                   (beside_.truth().missing.empty() ? "energy and the largest strain are."
                                                    : "only what each part costs is known.");
    } else {
      found_.why = nothing_can_go(allowed);
    }
  }

  std::string nothing_can_go(const std::string& allowed) const {
    const Variant* least = nullptr;
    for (const Candidate& candidate : candidates_)
      if (candidate.variant.change && (!least || *candidate.variant.change < *least->change))
        least = &candidate.variant;
    if (!least) return "Nothing can go: no part could be measured without.";
    if (*least->change > request_.tolerance)
      return "Nothing can go: the least that a part changes is " + percent(*least->change) +
             " of the size, " + least->name + allowed + ".";
    return "Nothing is worth dropping: what changes little enough, such as " + least->name + " (" +
           percent(*least->change) + " of the size" + allowed + "), saves less than 5 %.";
  }

  const Document& document_;
  const SimplifyRequest& request_;
  const Control<Simplification>& control_;
  Beside beside_;
  std::vector<Candidate> candidates_;
  Simplification found_;
};

}  // namespace

Result<Simplification> simplify(const Document& document, const SimplifyRequest& request,
                                const Control<Simplification>& control) {
  if (!(request.tolerance > 0.0) || request.tolerance > 1.0)
    return Error{"tolerance", significant(request.tolerance, 3), "above 0, at most 1"};
  if (request.time && !(*request.time > 0.0 && std::isfinite(*request.time)))
    return Error{"time", significant(*request.time, 3), "a time in seconds, above 0"};
  return Maker(document, request, control).make();
}

}  // namespace clothlab::lab
