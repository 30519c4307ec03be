// lab.*: jobs that measure the session's scene. The LabQueue answers a request once the session has reported
// which scene to measure; the notifications lab.progress and lab.result tell what a job finds.
#include <algorithm>

#include "server/lab/exports.h"
#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"
#include "server/stream/collider_text.h"

namespace clothlab::net {

namespace {

template <class Name, class List>
std::string names_of(const List& list, Name name) {
  std::string text;
  for (const auto item : list) text += (text.empty() ? "" : ", ") + std::string(name(item));
  return text;
}

/// The methods that the request names, each once. Empty: all methods.
std::vector<scene::Method> methods_in(Params& params) {
  std::vector<scene::Method> methods;
  const json& value = params.value("methods");
  bool good = value.is_null() || value.is_array();
  for (const json& item : value.is_array() ? value : json::array()) {
    const std::optional<scene::Method> method =
        item.is_string() ? scene::method_of(item.get<std::string>()) : std::nullopt;
    good = good && method;
    if (method && std::find(methods.begin(), methods.end(), *method) == methods.end())
      methods.push_back(*method);
  }
  if (!good)
    params.refuse("methods", "a list of methods, of " + names_of(scene::methods, [](scene::Method method) {
                               return scene::name(method);
                             }));
  return methods;
}

/// The iteration counts that the request names. Empty: the defaults of lab::ChartRequest.
std::vector<int> iterations_in(Params& params) {
  constexpr std::size_t most = 16;
  constexpr int least_value = static_cast<int>(scene::ranges::iterations.minimum),
                most_value = static_cast<int>(scene::ranges::iterations.maximum);
  std::vector<int> iterations;
  const json& value = params.value("iterations");
  bool good = value.is_null() || (value.is_array() && value.size() <= most);
  for (const json& item : value.is_array() ? value : json::array()) {
    good = good && item.is_number_integer() && item >= least_value && item <= most_value;
    if (good) iterations.push_back(item.get<int>());
  }
  if (!good)
    params.refuse("iterations", "a list of at most " + std::to_string(most) + " whole numbers in [" +
                                    std::to_string(least_value) + ", " + std::to_string(most_value) + "]");
  return iterations;
}

std::optional<double> number_in(Params& params, const char* name, double least, double most) {
  const double number = params.number(name, least, most, least);
  return params.has(name) ? std::optional(number) : std::nullopt;
}

std::optional<double> time_in(Params& params) {
  return number_in(params, "time", min_lab_time, max_lab_time);
}

constexpr double least_tolerance = 1e-9;

std::uint64_t job_in(Params& params) {
  constexpr std::int64_t most = (std::int64_t{1} << 53) - 1;  // JSON numbers are exact up to here
  return static_cast<std::uint64_t>(params.integer("job", 1, most, std::nullopt));
}

Outcome ask_lab(Client& client, Request& request, Params& params, lab::Job job) {
  const LabWishes wishes{params.flag("pause"), params.flag("fresh")};
  if (auto error = params.check()) return *error;
  LabQueue& lab = client.hub().lab();
  const auto admitted = lab.admit(ticket(client, request), client.room()->name(), std::move(job), wishes);
  if (const auto* refusal = std::get_if<RpcError>(&admitted)) return *refusal;
  const std::uint64_t id = std::get<std::uint64_t>(admitted);
  Outcome asked = ask_session(client, request, session::ReachScene{id});
  if (!std::holds_alternative<AnsweredLater>(asked)) lab.withdraw(id);
  return asked;
}

/// What the client's job has found so far, or why it has found nothing.
std::variant<SharedOutcome, RpcError> outcome_of(Client& client, std::uint64_t job) {
  auto found = client.hub().lab().outcome(client.id(), job);
  const auto* outcome = std::get_if<SharedOutcome>(&found);
  if (outcome && !*outcome)
    return invalid_params("/job", std::to_string(job) + " has no results yet", "wait for a lab.result of it");
  return found;
}

/// The bytes of the numbers, little-endian, as text (RFC 4648, padded).
std::string base64_of(const std::vector<float>& numbers) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(numbers.data());
  const std::size_t count = numbers.size() * sizeof(float);
  std::string text;
  text.reserve(count / 3 * 4 + 4);
  for (std::size_t i = 0; i < count; i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = i; k < i + 3; ++k) bits = bits << 8 | (k < count ? bytes[k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > count ? '=' : digits[bits >> (18 - 6 * k) & 63u];
  }
  return text;
}

}  // namespace

Outcome lab_chart(Client& client, Request& request) {
  Params params(request.params);
  lab::ChartRequest job;
  job.methods = methods_in(params);
  job.iterations = iterations_in(params);
  job.time = time_in(params);
  job.budget = params.number("budget", min_lab_budget, max_lab_budget, job.budget);
  return ask_lab(client, request, params, std::move(job));
}

Outcome lab_stability(Client& client, Request& request) {
  Params params(request.params);
  constexpr double least = -1e12, most = 1e12;  // for any field; the job checks the field's own range
  constexpr int least_columns = 2, most_columns = 41;
  lab::MapRequest job;
  job.methods = methods_in(params);
  job.field = params.text("field", job.field);
  job.from = number_in(params, "from", least, most);
  job.to = number_in(params, "to", least, most);
  job.columns = static_cast<int>(params.integer("columns", least_columns, most_columns, job.columns));
  return ask_lab(client, request, params, std::move(job));
}

Outcome lab_choose(Client& client, Request& request) {
  Params params(request.params);
  lab::ChooseRequest job;
  job.tolerance = params.number("tolerance", least_tolerance, 1, std::nullopt);
  job.methods = methods_in(params);
  job.time = time_in(params);
  return ask_lab(client, request, params, std::move(job));
}

Outcome lab_simplify(Client& client, Request& request) {
  Params params(request.params);
  lab::SimplifyRequest job;
  job.tolerance = params.number("tolerance", least_tolerance, 1, job.tolerance);
  job.time = time_in(params);
  return ask_lab(client, request, params, std::move(job));
}

Outcome lab_compare(Client& client, Request& request) {
  Params params(request.params);
  lab::CompareRequest job;
  if (params.has("patch")) job.patch = params.value("patch");
  if (!job.patch.is_object() && !job.patch.is_array())
    params.refuse("patch", "an object (RFC 7396 merge patch) or an array (RFC 6902 patch)");
  job.truth = params.flag("truth");
  job.time = params.number("time", min_lab_time, max_lab_time, job.time);
  job.rate = static_cast<int>(params.integer("rate", min_comparison_rate, max_comparison_rate, job.rate));
  return ask_lab(client, request, params, std::move(job));
}

Outcome lab_cancel(Client& client, Request& request) {
  Params params(request.params);
  const std::uint64_t job = job_in(params);
  if (auto error = params.check()) return *error;
  const auto cancelled = client.hub().lab().cancel(client.id(), job);
  if (const auto* error = std::get_if<RpcError>(&cancelled)) return *error;
  return json{{"job", job}, {"cancelled", std::get<bool>(cancelled)}};
}

Outcome lab_jobs(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  return json{{"jobs", client.hub().lab().jobs(client.id())}};
}

Outcome lab_export(Client& client, Request& request) {
  Params params(request.params);
  const std::uint64_t job = job_in(params);
  const std::string format = params.text("format", std::nullopt);
  if (format != "json" && format != "csv" && format != "svg") params.refuse("format", "json, csv or svg");
  const std::optional<lab::Axis> axis = lab::axis_of(params.text("axis", lab::name(lab::Axis::position)));
  if (!axis) params.refuse("axis", names_of(lab::all_axes, [](lab::Axis item) { return lab::name(item); }));
  if (auto error = params.check()) return *error;
  const auto found = outcome_of(client, job);
  if (const auto* error = std::get_if<RpcError>(&found)) return *error;
  const SharedOutcome& outcome = std::get<SharedOutcome>(found);
  if (format == "svg" && std::holds_alternative<lab::Comparison>(*outcome))
    return invalid_params("/format", "svg", "json or csv: there is no picture of a comparison");
  client.answer_aside(ticket(client, request), [outcome = outcome, job, format, axis = *axis] {
    std::string text = format == "svg"   ? lab::svg(*outcome, axis)
                       : format == "csv" ? lab::csv(*outcome)
                                         : lab::to_json(*outcome).dump(2) + "\n";
    return session::text_of({{"job", job}, {"format", format}, {"text", std::move(text)}});
  });
  return AnsweredLater{};
}

Outcome lab_moments(Client& client, Request& request) {
  Params params(request.params);
  const std::uint64_t job = job_in(params);
  const std::int64_t from = params.integer("from", 0, max_moment, std::nullopt);
  if (auto error = params.check()) return *error;
  const auto found = outcome_of(client, job);
  if (const auto* error = std::get_if<RpcError>(&found)) return *error;
  const auto* comparison = std::get_if<lab::Comparison>(std::get<SharedOutcome>(found).get());
  if (!comparison) return invalid_params("/job", std::to_string(job), "a job of lab.compare");
  const auto first = static_cast<std::size_t>(from);
  if (first > comparison->moments.size())
    return invalid_params("/from", std::to_string(from),
                          "0 to " + std::to_string(comparison->moments.size()) + ", the moments so far");
  std::vector<float> a, b;
  json colliders = json::array();
  std::size_t next = first;
  for (; next < comparison->moments.size(); ++next) {
    const lab::Moment& moment = *comparison->moments[next];
    if (next > first && (a.size() + moment.a.size()) * 2 * sizeof(float) > max_moments_bytes) break;
    a.insert(a.end(), moment.a.begin(), moment.a.end());
    b.insert(b.end(), moment.b.begin(), moment.b.end());
    colliders.push_back(stream::moving_colliders(moment.colliders));
  }
  return json{{"job", job},        {"from", first},     {"count", next - first},
              {"a", base64_of(a)}, {"b", base64_of(b)}, {"moving", std::move(colliders)}};
}

}  // namespace clothlab::net
