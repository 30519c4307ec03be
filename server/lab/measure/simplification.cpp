#include "server/lab/measure/simplification.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/automatic.h"
#include "server/lab/measure/substitutes.h"

namespace clothlab::lab {

namespace {

using scene::Document;

constexpr double truth_progress = 0.4;  // of the job's progress: computing the reference

/// "a", "a and b", "a, b and c".
std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

class SimplificationMeasurement {
 public:
  SimplificationMeasurement(const Document& document, const SimplifyRequest& request,
                            const Control<Simplification>& control)
      : document_(document),
        request_(request),
        control_(control),
        parts_(parts(document)),
        substitutes_(document, control.stop, request.timer) {}

  Result<Simplification> run() {
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
      control_.progress({truth_progress * share, 1.0, "the reference, in double precision"});
    };
    Status started = substitutes_.start(request_.time.value_or(1.0), progress, found_.notes);
    if (!started) return started;
    found_.size = substitutes_.truth().size;
    found_.time = substitutes_.truth().time;
    found_.horizon = substitutes_.compared_at();
    found_.whole = substitutes_.whole().variant;
    control_.arrived(found_);
    return ok();
  }

  Status measure_parts() {
    for (const Part& part : parts_) {
      control_.progress({progress(), 1.0, part.name});
      Substitute candidate;
      candidate.variant.name = part.name;
      candidate.variant.patch = scene::json::object();
      candidate.parts = {&part};
      Result<Document> without = part.without(document_);
      if (!without) {
        candidate.variant.reason = without.error().where.empty()
                                       ? without.error().what
                                       : without.error().where + ": " + without.error().what;
      } else if (Status measured = substitutes_.measure(candidate, std::move(*without)); !measured) {
        return measured;
      }
      candidates_.push_back(std::move(candidate));
      found_.variants.push_back(candidates_.back().variant);
      control_.arrived(found_);
    }
    std::vector<Substitute*> timed;
    for (Substitute& candidate : candidates_)
      if (candidate.variant.measured) timed.push_back(&candidate);
    control_.progress({progress(), 1.0, "timing, taking turns"});
    if (Status done = substitutes_.time(timed, request_.tolerance); !done) return done;
    show();
    return ok();
  }

  bool keeps_tolerance(const Variant& variant) const {
    return variant.measured && variant.change && *variant.change <= request_.tolerance;
  }

  /// Leaves out the part that saves most, then the others one by one, each only if it saves something more.
  Status recommend() {
    std::vector<Substitute*> saving;
    for (Substitute& candidate : candidates_)
      if (keeps_tolerance(candidate.variant) && candidate.variant.saving == Saving::yes)
        saving.push_back(&candidate);
    std::sort(saving.begin(), saving.end(), [](const Substitute* a, const Substitute* b) {
      return a->variant.cost_ratio.median < b->variant.cost_ratio.median;
    });
    std::vector<Substitute*> going;
    Substitute best;
    for (Substitute* next : saving) {
      if (going.empty()) {
        best = *next;
        going.push_back(next);
        continue;
      }
      if (best.excludes(*next->parts.front())) continue;
      if (Status tried = try_besides(best, going, next); !tried) return tried;
    }
    if (!going.empty()) recommended(going, best);
    return ok();
  }

  /// Adds `next` to the parts in `going` if all of them together keep the tolerance and cost less than
  /// `best`, the scene without those in `going`; otherwise adds a note that says why not.
  Status try_besides(Substitute& best, std::vector<Substitute*>& going, Substitute* next) {
    std::vector<Substitute*> all = going;
    all.push_back(next);
    Substitute together;
    if (Status measured = measure_together(all, together); !measured) return measured;
    const Variant& variant = together.variant;
    std::string why_not;
    if (!variant.change) {
      why_not = "together they could not be measured: " + variant.reason;
    } else if (*variant.change > request_.tolerance) {
      why_not = "together they change " + percent(*variant.change) + " of the size";
    } else {
      const Result<CostComparison> over = substitutes_.time_over(together, best);
      if (!over) return over.error();
      if (over->saving != Saving::yes)
        why_not = "that costs " + text(over->ratio) + " times " + best.variant.name + " alone" +
                  (over->saving == Saving::no ? "" : ", within the noise");
    }
    if (why_not.empty()) {
      best = std::move(together);
      going = std::move(all);
    } else {
      found_.notes.push_back(variant.name + ": " + why_not + ", so \"" + next->variant.name +
                             "\" is not recommended in addition.");
    }
    return ok();
  }

  /// Measures the scene without all the parts in `going` at once.
  Status measure_together(const std::vector<Substitute*>& going, Substitute& together) {
    std::vector<std::string> names;
    Document document = document_;
    for (const Substitute* candidate : going) {
      names.push_back(candidate->variant.name);
      together.parts.push_back(candidate->parts.front());
    }
    together.variant.name = list(names);
    // The mesh is made coarser after the other parts have been left out; a simpler model is fitted to the
    // rest.
    std::vector<const Part*> in_order = together.parts;
    std::stable_sort(in_order.begin(), in_order.end(), [](const Part* a, const Part* b) {
      return std::pair(!a->suffices.empty(), a->coarser > 1) <
             std::pair(!b->suffices.empty(), b->coarser > 1);
    });
    for (const Part* part : in_order) {
      Result<Document> without = part->without(document);
      if (!without) {
        together.variant.reason = without.error().what;
        return ok();
      }
      document = std::move(*without);
    }
    control_.progress({progress(), 1.0, "what can go, together"});
    return substitutes_.measure(together, std::move(document));
  }

  void recommended(const std::vector<Substitute*>& going, const Substitute& together) {
    for (Substitute* candidate : going) candidate->variant.recommended_to_drop = true;
    show();
    found_.recommended = together.variant;
    found_.recommended.recommended_to_drop = true;
    if (std::any_of(going.begin(), going.end(),
                    [](const Substitute* each) { return each->variant.name == without_damping; }))
      found_.notes.push_back("Damping was judged within " + with_significant_digits(found_.time, 3) +
                             " s: in the long run it is what brings a cloth to rest.");
  }

  void show() {
    found_.whole = substitutes_.whole().variant;
    found_.variants.clear();
    for (const Substitute& candidate : candidates_) found_.variants.push_back(candidate.variant);
    control_.arrived(found_);
  }

  double progress() const {
    const double share = static_cast<double>(found_.variants.size()) / static_cast<double>(parts_.size() + 2);
    return truth_progress + (1.0 - truth_progress) * share;
  }

  /// A line on each simpler model, of the cloth or of its contact, that was compared: whether it suffices
  /// here.
  std::string verdicts(const std::string& allowed) const {
    std::string lines;
    for (const Substitute& candidate : candidates_) {
      const Variant& variant = candidate.variant;
      const Part& part = *candidate.parts.front();
      if (part.suffices.empty() || !variant.change) continue;
      lines += (keeps_tolerance(variant) ? part.suffices : part.falls_short) +
               " here: " + percent(*variant.change) + " of the size" + allowed + ", " +
               text(variant.cost_ratio) + " times the time.\n";
    }
    return lines;
  }

  void explain() {
    const std::string allowed = " (" + percent(request_.tolerance) + " allowed)";
    if (!found_.whole.measured) {
      found_.why = "Nothing was compared, as the unchanged scene blows up: " + found_.whole.reason +
                   ". A stable step comes first.";
    } else if (found_.recommended.recommended_to_drop) {
      const Variant& best = found_.recommended;
      const double dt = best.patch.contains("solver") ? best.patch["solver"]["dt"].get<double>()
                                                      : document_.scene.solver.dt;
      found_.why = "The scene can do with this: " + best.name +
                   (dt > document_.scene.solver.dt
                        ? ", with a step of " + with_significant_digits(1000 * dt, 3) + " ms"
                        : "") +
                   "; that takes " + text(best.cost_ratio) + " times the time and changes positions by " +
                   percent(*best.change) + " of the size" + allowed + ".";
    } else if (found_.horizon == 0.0) {
      found_.why = std::string("Nothing is recommended, because positions cannot be compared; ") +
                   (substitutes_.truth().why_no_reference.empty() ? "energy and the largest strain are."
                                                                  : "only what each part costs is known.");
    } else {
      found_.why = nothing_can_go(allowed);
    }
    found_.why = verdicts(allowed) + found_.why;
  }

  std::string nothing_can_go(const std::string& allowed) const {
    const Variant* least = nullptr;
    for (const Substitute& candidate : candidates_)
      if (candidate.variant.change && (!least || *candidate.variant.change < *least->change))
        least = &candidate.variant;
    if (!least) return "Nothing can go: the scene could not be measured with any part left out.";
    if (*least->change > request_.tolerance)
      return "Nothing can go: the least that a part changes is " + percent(*least->change) +
             " of the size, " + least->name + allowed + ".";
    const Variant* unclear = nullptr;
    for (const Substitute& candidate : candidates_)
      if (keeps_tolerance(candidate.variant) && candidate.variant.saving == Saving::cannot_tell &&
          (!unclear || candidate.variant.cost_ratio.median < unclear->cost_ratio.median))
        unclear = &candidate.variant;
    if (unclear)
      return "Nothing is recommended: these timings cannot tell whether any part that changes little enough "
             "saves 5 % or more; " +
             unclear->name + " takes " + text(unclear->cost_ratio) +
             " times the time, within the noise. A quieter machine may tell.";
    return "Nothing is worth dropping: what changes little enough, such as " + least->name + " (" +
           percent(*least->change) + " of the size" + allowed + "), saves less than 5 %.";
  }

  const Document& document_;
  const SimplifyRequest& request_;
  const Control<Simplification>& control_;
  std::vector<Part> parts_;
  Substitutes substitutes_;
  std::vector<Substitute> candidates_;
  Simplification found_;
};

}  // namespace

bool Simplification::drops_several() const {
  return recommended.measured && std::none_of(variants.begin(), variants.end(), [&](const Variant& each) {
           return each.name == recommended.name;
         });
}

Result<Simplification> simplify(const Document& document, const SimplifyRequest& request,
                                const Control<Simplification>& control) {
  if (!(request.tolerance > 0.0) || request.tolerance > 1.0)
    return Error{"tolerance", with_significant_digits(request.tolerance, 3), "above 0, at most 1"};
  if (request.time && !(*request.time > 0.0 && std::isfinite(*request.time)))
    return Error{"time", with_significant_digits(*request.time, 3), "a time in seconds, above 0"};
  const Result<Document> concrete = with_provisional_setting(document);
  if (!concrete) return concrete.error();
  return SimplificationMeasurement(*concrete, request, control).run();
}

}  // namespace clothlab::lab
