#include "server/net/hub.h"

#include <algorithm>
#include <filesystem>
#include <random>

#include "server/base/memory.h"
#include "server/base/text.h"
#include "server/net/client.h"
#include "server/net/http.h"
#include "server/net/request_headers.h"
#include "server/session/keeper.h"

namespace clothlab::net {

namespace {

/// Compares in a time that does not reveal how much of a guessed token was right.
bool same(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? '\0' : b[i % b.size()]);
  return difference == 0;
}

/// The same with each proxy's address in the form in which clients' are compared.
Options with_plain_proxies(Options options) {
  for (std::string& proxy : options.trusted_proxies) proxy = plain_address(proxy);
  return options;
}

}  // namespace

const char* name(Role role) {
  return role == Role::operator_ ? "operator" : role == Role::viewer ? "viewer" : "none";
}

Hub::Hub(Options options, std::function<void()> wake)
    : options_(with_plain_proxies(std::move(options))),
      wake_(std::move(wake)),
      lab_(std::make_unique<LabQueue>(
          lab_port(),
          [gpu = options_.gpu, memory = options_.limits.scene.memory] { return open_lab(gpu, memory); },
          options_.limits.lab_seconds)),
      exporter_(
          [gpu = options_.gpu](const session::Moment& moment, const session::Export& what) {
            return session::make_export(gpu, moment, what);
          },
          wake_) {}

Hub::~Hub() {
  stop_sessions();
}

LabQueue::Port Hub::lab_port() {
  LabQueue::Port port;
  port.notify = [this](std::uint64_t id, const char* method, const json& params) {
    if (Client* client = find_client(id)) client->send(notification_text(method, params));
  };
  port.answer = [this](const session::Ticket& ticket, const json& answer) {
    if (Client* client = find_client(ticket.asker)) client->answer(ticket, answer);
  };
  port.hold = [this](const std::string& session, std::uint64_t job) {
    if (Room* room = find_room(session)) room->post({{}, session::Hold{job}});
  };
  port.release = [this](const std::string& session) {
    if (Room* room = find_room(session)) room->post({{}, session::Release{}});
  };
  port.steps = [this] { return steps(); };
  // The sessions' renderer is the lab's, too: the lab's context is on the device that the sessions run on.
  const auto key = [this](const scene::Document& document, const lab::Job& job) {
    return lab::cache_key(document, job, renderer());
  };
  port.known = [this, key](const scene::Document& document, const lab::Job& job) {
    return lab_cache_.find(key(document, job));
  };
  port.keep = [this, key](const scene::Document& document, const lab::Job& job, const lab::Outcome& outcome) {
    lab_cache_.keep(key(document, job), outcome);
  };
  port.chosen = [this](const std::string& session, SharedDocument measured, Result<lab::Choice> choice) {
    if (Room* room = find_room(session))
      room->post({{}, session::Chosen{std::move(measured), std::move(choice)}});
  };
  port.wake = wake_;
  return port;
}

Status Hub::join_bus() {
  if (options_.bus.empty()) return ok();
  std::random_device random;
  run_name_ = formatted("%08x%08x", random(), random());
  std::size_t most_come = bus::usual_most_come;
  if (const std::shared_ptr<MemoryBudget>& memory = limits().scene.memory; memory && relays()) {
    // A relay has no past to go back to: that share is for what has come and was not looked at yet.
    constexpr MemoryBudget::Use use = MemoryBudget::Use::timelines;
    most_come = std::min(most_come, static_cast<std::size_t>(memory->share(use)));
    bus_memory_ = std::move(*MemoryBudget::reserve(memory, use, most_come));
  }
  Result<std::unique_ptr<bus::Bus>> joined =
      bus::connect(options_.bus, relays() ? "clothlab relay" : "clothlab serve", wake_, most_come);
  if (!joined) return joined.error();
  bus_ = std::move(*joined);
  return ok();
}

Role Hub::role_of(const std::string& token) const {
  if (!needs_token()) return relays() ? Role::viewer : Role::operator_;
  if (!options_.token.empty() && same(token, options_.token)) return Role::operator_;
  if (!options_.view_token.empty() && same(token, options_.view_token)) return Role::viewer;
  return Role::none;
}

TokenCheck Hub::check_token(const std::string& token, const std::string& address, std::vector<LogField> who) {
  const std::int64_t now = session::now_us();
  const std::string network = network_of(address);
  if (const int wait = token_guard_.wait(network, now)) {
    ++metrics_.tokens_refused;
    return {Role::none, wait};
  }
  const Role role = role_of(token);
  if (role != Role::none) return {role, 0};
  ++metrics_.tokens_refused;
  token_guard_.was_wrong(network, now);
  who.push_back({"address", address});
  log(LogLevel::warning, "token_refused", who);
  return {};
}

std::string Hub::host_refusal(const std::string& host) const {
  // Where everybody may watch, nobody needs another's name to do so.
  if (needs_token() || (relays() && !is_loopback(options_.bind))) return {};
  if (host_trusted(host, options_.allow_origin)) return {};
  const std::string name = host_text(host);
  const std::string scheme = options_.tls_certificate.empty() ? "http://" : "https://";
  return "this server requires no token, and so answers under an address or localhost only, not as " + name +
         ": open it as 127.0.0.1 or localhost, or start it with --allow-origin " + scheme + name +
         ", or with --token";
}

Room* Hub::find_room(const std::string& name) {
  const auto found = rooms_.find(name);
  return found == rooms_.end() ? nullptr : found->second.get();
}

bool Hub::has_place_for(const std::string& name) {
  return find_room(name) || rooms_.size() < static_cast<std::size_t>(limits().sessions) ||
         !sleeping_room().empty();
}

std::string Hub::renderer() const {
  for (const auto& [name, room] : rooms_)
    if (room->started()) return room->renderer();
  return {};
}

Room* Hub::open_room(const std::string& name) {
  if (Room* room = find_room(name)) return room;
  if (!has_place_for(name)) return nullptr;
  Lock claim;
  if (options_.share_state) {
    Result<Lock> taken = Lock::file(lock_file(name));
    if (!taken) return nullptr;
    claim = std::move(*taken);
    claim.write({});  // what a server wrote that was killed
  }
  if (rooms_.size() >= static_cast<std::size_t>(limits().sessions)) retire(sleeping_room());
  return (rooms_[name] = std::make_unique<Room>(*this, name, wake_, std::move(claim))).get();
}

std::filesystem::path Hub::lock_file(const std::string& name) const {
  return options_.state_folder / (name + ".lock");
}

bool Hub::elsewhere(const std::string& name) {
  return options_.share_state && !find_room(name) && Lock::held_by_another(lock_file(name));
}

void Hub::give_up_sleeping_rooms() {
  if (!opens_on_demand()) return;
  for (std::string name = sleeping_room(); !name.empty(); name = sleeping_room()) retire(name);
}

bool Hub::knows_session(const std::string& name) {
  if (find_room(name) || name == main_session || relays()) return true;
  std::error_code failure;
  return !options_.state_folder.empty() &&
         std::filesystem::exists(session::session_file(options_.state_folder, name), failure);
}

std::string Hub::sleeping_room() const {
  std::string longest;
  std::int64_t since = session::now_us() - std::int64_t{limits().scene.unwatched_seconds} * 1'000'000;
  for (const auto& [name, room] : rooms_) {
    if ((name == main_session && !opens_on_demand()) || !room->empty() || room->unwatched_since() > since)
      continue;
    since = room->unwatched_since();
    longest = name;
  }
  return longest;
}

void Hub::retire(const std::string& name) {
  const auto found = rooms_.find(name);
  lab_->session_left(name);
  if (relays()) return void(rooms_.erase(found));  // it has no thread to wait for
  // The session's thread may need a turn to end, so another thread waits for it. Futures of threads that have
  // ended are dropped, because each keeps its thread's stack.
  std::erase_if(retiring_, [](const std::future<void>& end) {
    return end.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  });
  retiring_.push_back(std::async(std::launch::async, [session = found->second->give_up_session(),
                                                      claim = found->second->give_up_claim()]() mutable {
    session.reset();
    claim = Lock();  // after the session is saved
    release_free_memory();
  }));
  rooms_.erase(found);
}

void Hub::add(Client& client) {
  clients_[client.id()] = &client;
}
void Hub::remove(Client& client) {
  clients_.erase(client.id());
  forget_full();
}

Client* Hub::find_client(std::uint64_t id) {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : found->second;
}

void Hub::close_slowest_reader(Client& otherwise) {
  Client* slowest = nullptr;
  for (const auto& [id, client] : clients_)
    if (client->keeps_much() && (!slowest || client->took_last() < slowest->took_last())) slowest = client;
  (slowest ? slowest : &otherwise)
      ->close(close_policy, "messages are not being read, and the server has no memory to keep more");
}

void Hub::close_all(int code, const std::string& reason) {
  for (const auto& [id, client] : clients_) client->close(code, reason);
}

std::size_t Hub::exports_waiting() const {
  std::size_t count = captured_.size() + (exporter_.idle() ? 0 : 1);
  for (const auto& [name, room] : rooms_) count += room->capturing();
  return count;
}

void Hub::captured(session::Captured captured) {
  if (!captured.moment) return deliver({captured.asker, "", captured.moment.error()});
  captured_.push_back(std::move(captured));
}

void Hub::make_of_recording(std::uint64_t asker, const session::RecordingFacts& recording,
                            const std::string& ending) {
  session::Export what;
  what.recording = ending;
  captured_.push_back({asker, what, session::Moment{nullptr, 0, {}, {}, recording.file, recording.scene}});
  pump_exports();
}

std::shared_ptr<const std::string> Hub::made_of(const std::shared_ptr<const std::string>& recording,
                                                const std::string& ending) const {
  for (const MadeFile& made : made_files_)
    if (recording && made.ending == ending && made.recording.lock() == recording) return made.file.lock();
  return nullptr;
}

void Hub::pump_exports() {
  if (std::optional<session::Exported> exported = exporter_.take()) {
    ++metrics_.exports;
    deliver(std::move(*exported));
  }
  while (exporter_.idle() && !captured_.empty()) {
    session::Captured next = std::move(captured_.front());
    captured_.pop_front();
    const auto asker = waiting_.find(next.asker);
    if (asker == waiting_.end() || asker->second->hung_up()) continue;
    if (std::shared_ptr<const std::string> made = made_of(next.moment->recording, next.what.recording)) {
      deliver_made(next.asker, std::move(made));
      continue;
    }
    exporter_.begin(next.asker, next.what, std::move(*next.moment));
  }
}

HttpRequest* Hub::find_request(std::uint64_t id) {
  const auto found = waiting_.find(id);
  return found == waiting_.end() ? nullptr : found->second;
}

void Hub::deliver(session::Exported exported) {
  HttpRequest* request = find_request(exported.asker);
  if (!request) return;
  if (!exported.recording || !exported.body) return request->deliver(std::move(exported));
  MemoryBudget::Reservation memory = request->take_memory();
  (void)memory.resize(exported.body->capacity());
  std::shared_ptr<const std::string> file = held_text(std::move(*exported.body), std::move(memory));
  std::erase_if(made_files_, [](const MadeFile& old) { return old.file.expired(); });
  made_files_.push_back({exported.recording, exported.ending, file});
  request->deliver_made(std::move(file));
}

void Hub::deliver_made(std::uint64_t asker, std::shared_ptr<const std::string> file) {
  if (HttpRequest* request = find_request(asker)) request->deliver_made(std::move(file));
}

void Hub::deliver_collider(std::uint64_t asker, const relay::Feed::ColliderMesh& mesh) {
  if (HttpRequest* request = find_request(asker)) request->deliver_collider(mesh);
}

void Hub::pump_bus() {
  if (!bus_) return;
  bus_->take(from_bus_);
  for (const bus::Message& message : from_bus_)
    if (Room* room = find_room(relay::session_of(message.subject))) room->receive(message);
}

void Hub::pump() {
  pump_bus();
  std::vector<std::string> failed;
  for (const auto& [name, room] : rooms_) {
    room->pump();
    if (!room->failure()) continue;
    if (name == main_session && !main_failure_) main_failure_ = room->failure();
    failed.push_back(name);
  }
  for (const std::string& name : failed) retire(name);
  pump_exports();
  workbench_.pump();
  lab_->pump(session::now_us());
}

void Hub::stop_sessions() {
  for (const auto& [name, room] : rooms_) room->stop();
  lab_->stop();
  for (const auto& [name, room] : rooms_) room->give_up_session().reset();
  if (bus_) bus_->close();
  retiring_.clear();  // waits for each session that is being closed
  exporter_.stop();
  workbench_.stop();
}

Gauges Hub::gauges() const {
  Gauges gauges{rooms_.size(), clients_.size(), 0, steps(), lab_->gauges(), 0, exports_waiting()};
  for (const auto& [name, room] : rooms_) {
    gauges.asleep += room->asleep() ? 1u : 0u;
    gauges.memory_bytes += room->memory_bytes();
    gauges.stuck += room->beats() ? 0u : 1u;
    if (const std::optional<double> pace = room->pace())
      gauges.slowest = std::min(gauges.slowest.value_or(*pace), *pace);
  }
  gauges.memory = limits().scene.memory;
  if (bus_) gauges.bus = bus_->counts();
  for (const auto& [id, client] : clients_) gauges.viewers += client->pacing().subscribed() ? 1u : 0u;
  return gauges;
}

std::uint64_t Hub::steps() const {
  std::uint64_t steps = 0;
  for (const auto& [name, room] : rooms_) steps += room->steps();
  return steps;
}

bool Hub::all_sessions_beat() const {
  for (const auto& [name, room] : rooms_)
    if (!room->beats()) return false;
  return true;
}

}  // namespace clothlab::net
