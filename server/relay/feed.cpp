#include "server/relay/feed.h"

#include <algorithm>
#include <utility>

#include "server/scene/document.h"
#include "server/scene/memory.h"
#include "server/scene/pointer.h"

namespace clothlab::relay {

namespace {

/// Time for viewers' requests at a time [us]: many must not keep frames waiting. What is left is done by the
/// next call, which the answers to these cause.
constexpr std::int64_t longest_turn_us = 4000;
constexpr std::int64_t hurry_us =
    200'000;  ///< the least time between two wants, but for those of new viewers
/// Before the name, as JSON, of the collider whose mesh is in an answer.
constexpr std::string_view collider_note = "collider ";

std::string_view text_in(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What a relay carries out of a change itself, on the thread that serves its viewers.
constexpr scene::PatchLimits little{1u << 17, scene::max_document_bytes, 1u << 17, 1u << 20};

/// A document that a server may have.
bool is_served(const json& document) {
  return document.is_object() && scene::depth(document) <= static_cast<int>(scene::max_json_depth) &&
         scene::check_bytes(document);
}

/// A copy of the message with the room in front that libwebsockets needs, and the header rewritten.
std::shared_ptr<stream::Message> renumbered(const std::vector<std::uint8_t>& bytes,
                                            const stream::Header& header) {
  auto message = std::make_shared<stream::Message>();
  message->header = header;
  message->bytes.reserve(stream::front_room + bytes.size());
  message->bytes.resize(stream::front_room);
  message->bytes.insert(message->bytes.end(), bytes.begin(), bytes.end());
  stream::write_header(header, message->bytes.data() + stream::front_room);
  return message;
}

}  // namespace

Feed::Feed(bus::Bus& bus, std::string session, std::string relay, Deliver deliver, std::function<void()> wake,
           std::shared_ptr<MemoryBudget> budget)
    : Source(std::move(wake)),
      bus_(bus),
      budget_(std::move(budget)),
      session_(std::move(session)),
      deliver_(std::move(deliver)),
      begun_(session::now_us()) {
  std::vector<MemoryBudget::Reservation*> all{&document_memory_, &topology_memory_, &colliders_memory_};
  for (MemoryBudget::Reservation& each : frame_memory_) all.push_back(&each);
  for (MemoryBudget::Reservation* each : all)
    *each = std::move(*MemoryBudget::reserve(budget_, MemoryBudget::Use::simulations, 0));
  want_.relay = std::move(relay);
  bus_.subscribe(answer_subject(session_, want_.relay), bus::Keep::all);
  bus_.subscribe(subject(session_, text_word), bus::Keep::all);
  bus_.subscribe(subject(session_, topology_word), bus::Keep::all);
}

Feed::~Feed() {
  set_rates({});
  for (const std::string& each : {answer_subject(session_, want_.relay), subject(session_, text_word),
                                  subject(session_, topology_word)})
    bus_.unsubscribe(each);
  want_.viewers = 0;
  bus_.send({subject(session_, want_word), bus::bytes_of(text_of(want_))}, bus::Keep::all);
}

void Feed::pump(std::int64_t now) {
  while (session::now_us() - now < longest_turn_us) {
    std::optional<session::Command> command = exchange_.next_command();
    if (!command) break;
    carry_out(*command, now);
  }
  if (now >= want_due_) send_want(now);
  look_for_silence(now);
}

void Feed::carry_out(session::Command& command, std::int64_t now) {
  if (const auto* watchers = std::get_if<session::Watchers>(&command.what)) {
    want_.viewers = watchers->count;
    want_soon(now);
  } else if (const auto* demand = std::get_if<session::Demand>(&command.what)) {
    if (demand->rate != want_.rates) want_due_ = now;
    set_rates(demand->rate);
  } else if (std::holds_alternative<session::GetScene>(command.what)) {
    exchange_.emit(session::Reply{command.ticket, scene_text_});
  }
}

void Feed::set_rates(const Rates& rates) {
  for (std::size_t i = 0; i < form_count; ++i) {
    if ((rates[i] > 0) == (want_.rates[i] > 0)) continue;
    const std::string frames = frame_subject(session_, stream::Form::at(i));
    if (rates[i] > 0)
      bus_.subscribe(frames, bus::Keep::newest);
    else
      bus_.unsubscribe(frames);
  }
  want_.rates = rates;
}

void Feed::want_soon(std::int64_t now) {
  want_due_ = std::min(want_due_, std::max(now, wanted_ + hurry_us));
}

void Feed::send_want(std::int64_t now) {
  wanted_ = now;
  want_due_ = now + want_period_us;
  bus_.send({subject(session_, want_word),
             bus::bytes_of(text_of(want_)),
             {},
             answer_subject(session_, want_.relay)},
            bus::Keep::all);
}

void Feed::heard(std::int64_t now) {
  heard_ = now;
  if (std::exchange(silent_, false)) tell("info", "the session's server answers again");
}

void Feed::look_for_silence(std::int64_t now) {
  if (!started_ && !failed_ && now - begun_ > patience_us) {
    failed_ = true;
    exchange_.emit(session::Failed{{"session " + session_, "its server does not answer over the bus",
                                    "try again; an operator sees to it that the server and the bus run"}});
  }
  if (started_ && !silent_ && now - heard_ > patience_us) {
    silent_ = true;
    tell("warning", "the session's server does not answer; the cloth stands still here until it does");
  }
}

void Feed::tell(const char* level, const std::string& text) {
  exchange_.emit(session::Notice{level, text});
}

/// Reserves so many bytes in the place of what was reserved there. False: there are not so many. Then viewers
/// are told, once; those of a session that cannot begin for that are told and closed.
bool Feed::keep(MemoryBudget::Reservation& memory, std::size_t bytes) {
  const Status kept = memory.resize(bytes);
  if (kept) return true;
  const std::string why =
      "this relay has no memory for all of session " + session_ + ": " + kept.error().text();
  if (!std::exchange(told_of_memory_, true) && started_) tell("error", why);
  if (started_) return false;
  failed_ = true;
  exchange_.emit(session::Failed{{"session " + session_, kept.error().text(), "a larger --max-memory"}});
  return false;
}

void Feed::receive(const bus::Message& message, std::int64_t now) {
  if (failed_) return;
  if (message.subject == answer_subject(session_, want_.relay)) return take_answer(message, now);
  if (!started_) return;
  if (message.subject == subject(session_, text_word)) return take_text(message, now);
  if (message.subject == subject(session_, topology_word)) return take_topology(message.bytes);
  for (std::size_t i = 0; i < form_count; ++i)
    if (want_.rates[i] > 0 && message.subject == frame_subject(session_, stream::Form::at(i)))
      return take_frame(message, stream::Form::at(i), now);
}

void Feed::take_answer(const bus::Message& message, std::int64_t now) {
  if (message.unheard) {
    if (started_) return;
    failed_ = true;
    return exchange_.emit(session::Failed{{"session " + session_, "no server on the bus has it open",
                                           "an operator opens it by connecting to its server"}});
  }
  heard(now);
  if (message.note.starts_with(collider_note))
    return take_collider(message.note.substr(collider_note.size()), message.bytes);
  if (!message.bytes.empty() &&
      message.bytes.front() == static_cast<std::uint8_t>(stream::MessageKind::topology))
    return take_topology(message.bytes);
  const json state = value_of(text_in(message.bytes));
  try {
    if (state.is_object()) take_state(state, now);
  } catch (const json::exception&) {  // not what a server of this version says
  }
}

/// What the server answers to a want: of all that viewers get first, that which this relay does not have.
void Feed::take_state(const json& state, std::int64_t now) {
  const auto origin = state.at("origin").get<std::string>();
  const bool other = origin != want_.known.origin;
  if (other) renumber_ = true;
  if (other && !want_.known.origin.empty()) origin_changed(now);
  want_.known.origin = origin;
  if (const auto scene = state.find("document"); scene != state.end()) {
    const auto revision = state.at("revision").get<std::uint64_t>();
    take_scene(*scene, revision, started_ && !other && revision == revision_);
  }
  if (const auto history = state.find("history"); history != state.end() && history->is_object())
    exchange_.emit(session::HistoryChanged{*history});
  renderer_ = state.value("renderer", renderer_);
  if (!started_ && document_.is_object() && topology_) {
    started_ = true;
    exchange_.emit(session::Started{renderer_});
  }
}

/// A server that was started again answers under another name once; two servers take turns.
void Feed::origin_changed(std::int64_t now) {
  const bool soon = origin_changed_ && now - *origin_changed_ < patience_us;
  origin_changed_ = now;
  if (!soon || std::exchange(told_of_two_, true)) return;
  tell("error", "two servers publish the session " + session_ +
                    " on this bus, and both are shown; one of them has to use another name, or another bus");
}

void Feed::take_scene(json document, std::uint64_t revision, bool told) {
  if (!is_served(document)) return;  // not what a server of this version says
  want_.known.revision = revision;   // also if there is no room for it: it is asked for once
  // With the copy for viewers, and its text twice: alone, and in the message for all.
  if (!keep(document_memory_, 2 * scene::memory_of(document) + 2 * text_of(document).size())) return;
  if (!told) forget_colliders();
  document_ = std::move(document);
  revision_ = want_.known.revision = revision;
  tell_scene(std::nullopt, 0, told);
}

void Feed::tell_scene(std::optional<json> patch, std::uint64_t by, bool told) {
  auto shared = std::make_shared<scene::Document>();
  shared->value = document_;
  scene_text_ = session::text_of({{"document", document_}, {"revision", revision_}});
  exchange_.emit(
      session::SceneChanged{std::move(shared), scene_text_, revision_, std::move(patch), by, told});
}

void Feed::take_text(const bus::Message& message, std::int64_t now) {
  const json said = value_of(text_in(message.bytes));
  try {
    if (!said.is_object()) return;
    const auto method = said.at("method").get<std::string>();
    const json& params = said.at("params");
    if (method == "scene")
      take_scene(params.at("document"), params.at("revision").get<std::uint64_t>(), false);
    else if (method == "scene.changed")
      take_patch(params, now);
    else if (method == "scene.history")
      exchange_.emit(session::HistoryChanged{params});
    else if (method == "sim.status")
      take_status(said);
    else
      exchange_.emit(session::Told{std::string(text_in(message.bytes)), false});
  } catch (const json::exception&) {  // not what a server of this version says
  }
}

/// Passes a status on. What it says of a topology, it says of one that has another revision here.
void Feed::take_status(json status) {
  json& params = status.at("params");
  if (const auto renumbered = params.find("renumbered"); renumbered != params.end()) {
    json& revision = renumbered->at("topology_revision");
    const bool here = topology_ && revision == json(want_.known.topology);
    revision = here ? topology_->header.topology_revision : 0;
  }
  exchange_.emit(session::Told{text_of(status), true});
}

/// Passes a change on at once. It is made here as the page makes it, without the defaults that the server
/// fills in: the next answer brings the whole document, for those who come later. One that is too much to
/// make here is asked for as a whole.
void Feed::take_patch(const json& params, std::int64_t now) {
  const auto revision = params.at("revision").get<std::uint64_t>();
  if (revision <= revision_) return;
  if (revision > revision_ + 1) return want_soon(now);  // one before it was lost: all is asked for again
  const json& patch = params.at("patch");
  Result<json> changed = scene::patched(document_, patch, little);
  if (!changed || !is_served(*changed)) return want_soon(now);
  if (changed->value("colliders", json()) != document_.value("colliders", json())) forget_colliders();
  document_ = std::move(*changed);
  revision_ = revision;
  tell_scene(patch, params.value("by", std::uint64_t{0}), false);
}

void Feed::take_topology(const std::vector<std::uint8_t>& bytes) {
  std::optional<stream::Header> header = stream::read_header(bytes.data(), bytes.size());
  if (!header || header->kind != stream::MessageKind::topology) return;
  want_.known.topology = header->topology_revision;  // also if there is no room for it: it is asked for once
  if (bytes == their_topology_) return;
  topology_fits_ = keep(topology_memory_, 2 * bytes.size());
  if (!topology_fits_) return;
  their_topology_ = bytes;
  header->topology_revision = topology_ ? topology_->header.topology_revision + 1 : 1;
  topology_ = renumbered(bytes, *header);
  exchange_.forget_frames();
  exchange_.emit(session::TopologyChanged{topology_});
}

void Feed::take_frame(const bus::Message& message, stream::Form form, std::int64_t now) {
  std::optional<stream::Header> header = stream::read_header(message.bytes.data(), message.bytes.size());
  if (!header || header->kind != stream::MessageKind::frame || header->encoding != form.encoding) return;
  if (header->topology_revision != want_.known.topology) return want_soon(now);
  // With the one that is on its way to viewers, and the one that has come.
  if (!topology_fits_ || !keep(frame_memory_[form.index()], 3 * message.bytes.size())) return;
  if (std::exchange(renumber_, false)) frame_offset_ = last_frame_ + 1 - header->sequence;
  header->sequence += frame_offset_;
  // Of different forms frames may come a little out of order.
  if (static_cast<std::int32_t>(header->sequence - last_frame_) > 0) last_frame_ = header->sequence;
  header->topology_revision = topology_->header.topology_revision;
  header->field = form.field;
  const std::shared_ptr<stream::Message> frame = renumbered(message.bytes, *header);
  frame->made_at_us = now;
  if (!message.note.empty()) {
    frame->colliders.resize(stream::front_room);
    frame->colliders.insert(frame->colliders.end(), message.note.begin(), message.note.end());
  }
  exchange_.publish(frame);
}

void Feed::forget_colliders() {
  colliders_.clear();
  (void)colliders_memory_.resize(0);
}

Feed::ColliderMesh Feed::collider(const std::string& name) const {
  const auto found = colliders_.find(name);
  return found == colliders_.end() ? nullptr : found->second;
}

void Feed::ask_collider(const std::string& name, std::uint64_t asker) {
  const std::int64_t now = session::now_us();
  std::erase_if(asked_, [&](const auto& item) { return now - item.second.at > patience_us; });
  Asked& asked = asked_[name];
  asked.askers.push_back(asker);
  if (now - asked.at < want_period_us) return;
  asked.at = now;
  bus_.send(
      {subject(session_, collider_word), bus::bytes_of(name), {}, answer_subject(session_, want_.relay)},
      bus::Keep::all);
}

void Feed::take_collider(const std::string& quoted_name, const std::vector<std::uint8_t>& bytes) {
  const json parsed = value_of(quoted_name);
  const auto name = parsed.is_string() ? parsed.get<std::string>() : std::string();
  const auto found = asked_.find(name);
  if (found == asked_.end()) return;
  const std::vector<std::uint64_t> askers = std::move(found->second.askers);
  asked_.erase(found);
  ColliderMesh mesh;
  if (!bytes.empty() && keep(colliders_memory_, colliders_memory_.bytes() + bytes.size()))
    mesh = colliders_[name] = std::make_shared<const std::string>(text_in(bytes));
  for (const std::uint64_t asker : askers) deliver_(asker, mesh);
}

}  // namespace clothlab::relay
