// These definitions replace those in server/session/session.cpp and server/net/lab_worker.cpp (whose objects
// the linker then leaves in their library) and those of libwebsockets.
#include "tests/fuzz/no_machine.h"

#include <libwebsockets.h>

#include <algorithm>
#include <map>

#include "server/net/lab_worker.h"
#include "server/session/session.h"
#include "server/sim/simulation.h"

namespace clothlab {

// The network.
namespace fuzz {

namespace {

struct Connection {
  std::vector<std::string> sent;
  bool close_said = false;
};
std::map<const lws*, Connection>& connections() {
  static std::map<const lws*, Connection> all;
  return all;
}
Arrival arrival;

std::vector<session::Session*>& sessions() {
  static std::vector<session::Session*> all;
  return all;
}

}  // namespace

void set_arrival(const Arrival& next) {
  arrival = next;
}

lws* connect() {
  auto* handle = reinterpret_cast<lws*>(new char);  // a unique address that nobody reads
  connections()[handle];
  return handle;
}

void disconnect(lws* wsi) {
  connections().erase(wsi);
  delete reinterpret_cast<char*>(wsi);
}

std::vector<std::string> take_sent(const lws* wsi) {
  return std::exchange(connections().at(wsi).sent, {});
}

bool close_was_said(const lws* wsi) {
  return connections().at(wsi).close_said;
}

}  // namespace fuzz

// The session.
namespace session {

namespace {

/// A session's state, and what commands do to it: patches change the document and are told, but nothing is
/// stepped.
class Scribe {
 public:
  Scribe(scene::Document document, Exchange& exchange)
      : document_(std::move(document)), exchange_(&exchange) {
    document_.assets = meshes_;
    tell({}, 0);
    exchange_->emit(Started{"none"});
    exchange_->emit(SolverChanged{json::object()});
  }

  void perform(const Command& command) {
    const Ticket& ticket = command.ticket;
    if (std::holds_alternative<GetScene>(command.what)) return reply(ticket, scene());
    if (const auto* load = std::get_if<LoadScene>(&command.what))
      return take(ticket,
                  load->preset.empty() ? scene::validate(load->document, meshes_)
                                       : scene::load_preset(load->preset, meshes_),
                  {});
    if (const auto* upload = std::get_if<UploadMesh>(&command.what)) {
      const Result<MeshShelf::SharedItem> item = meshes_->read(upload->name, upload->bytes);
      if (!item) return reply(ticket, invalid_value({"/obj", item.error().text(), item.error().remedy}));
      if (const auto place = meshes_->make_place(upload->name, upload->bytes.size(), {}); place)
        meshes_->exchange(upload->name, *item);
    }
    if (const auto* patch = std::get_if<PatchScene>(&command.what)) {
      if (patch->revision && *patch->revision != revision_)
        return reply(ticket, Refusal{Refusal::Reason::other_revision, {"", "conflict", ""}, revision_});
      return take(ticket, scene::apply_patch(document_, patch->patch), patch->patch);
    }
    if (const auto* reach = std::get_if<ReachScene>(&command.what))
      return exchange_->emit(SceneReached{reach->job});
    if (const auto* hold = std::get_if<Hold>(&command.what)) return exchange_->emit(Held{hold->job});
    reply(ticket, json::object());  // Demand, Watchers, ... have no id
  }

 private:
  void reply(const Ticket& ticket, std::variant<json, Refusal> answer) {
    if (!ticket.id) return;
    if (auto* refusal = std::get_if<Refusal>(&answer))
      exchange_->emit(Reply{ticket, std::move(*refusal)});
    else
      exchange_->emit(Reply{ticket, text_of(std::get<json>(answer))});
  }
  json scene() const { return {{"document", document_.value}, {"revision", revision_}}; }
  void take(const Ticket& ticket, Result<scene::Document> document, std::optional<json> patch) {
    if (!document) return reply(ticket, invalid_value(document.error()));
    document_ = std::move(*document);
    ++revision_;
    reply(ticket, json{{"revision", revision_}});
    tell(std::move(patch), ticket.asker);
  }
  void tell(std::optional<json> patch, std::uint64_t by) {
    exchange_->emit(SceneChanged{std::make_shared<const scene::Document>(document_), text_of(scene()),
                                 revision_, std::move(patch), by});
  }

  std::shared_ptr<MeshShelf> meshes_ = std::make_shared<MeshShelf>();
  scene::Document document_;
  Exchange* exchange_;
  std::uint64_t revision_ = 0;
};

std::map<const Session*, Scribe>& scribes() {
  static std::map<const Session*, Scribe> all;
  return all;
}

}  // namespace

Session::Session(Beginning beginning, const Limits&, std::optional<int>, std::function<void()> wake)
    : Source(std::move(wake)) {
  exchange_.beat();
  scribes().emplace(this, Scribe(std::move(beginning.document), exchange_));
  fuzz::sessions().push_back(this);
}

Session::~Session() {
  scribes().erase(this);
  std::erase(fuzz::sessions(), this);
}

}  // namespace session

// The lab.
namespace net {

LabWorker::~LabWorker() = default;

void LabWorker::begin(Task task) {
  busy_ = true;
  mail_.ended = Ended{task.id, Error{"lab", "nothing is measured here", "a machine"}};
}

LabWorker::Mail LabWorker::take() {
  if (mail_.ended) busy_ = false;
  return std::exchange(mail_, {});
}

Result<LabWorker::Run> open_lab(std::optional<int>, std::shared_ptr<MemoryBudget>) {
  return Error{"lab", "no OpenGL", "a machine"};
}

}  // namespace net

bool fuzz::answer_commands() {
  bool any = false;
  for (session::Session* session : sessions())
    while (const std::optional<session::Command> command = session->exchange().next_command()) {
      any = true;
      session::scribes().at(session).perform(*command);
    }
  return any;
}

}  // namespace clothlab

// The functions of libwebsockets that a Client calls.
extern "C" {

void lws_set_timer_usecs(lws*, lws_usec_t) {}
void lws_set_timeout(lws*, enum pending_timeout, int) {}
int lws_callback_on_writable(lws*) {
  return 1;
}
int lws_is_first_fragment(lws*) {
  return clothlab::fuzz::arrival.first ? 1 : 0;
}
int lws_is_final_fragment(lws*) {
  return clothlab::fuzz::arrival.last ? 1 : 0;
}
int lws_frame_is_binary(lws*) {
  return clothlab::fuzz::arrival.binary ? 1 : 0;
}
size_t lws_remaining_packet_payload(lws*) {
  return 0;
}
lws_sockfd_type lws_get_socket_fd(lws*) {
  return -1;
}
int lws_write(lws* wsi, unsigned char* data, size_t size, enum lws_write_protocol protocol) {
  auto& connection = clothlab::fuzz::connections().at(wsi);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (protocol == LWS_WRITE_TEXT) connection.sent.push_back(bytes);
  if (protocol == LWS_WRITE_RAW) connection.close_said = true;
  return static_cast<int>(size);
}
}
