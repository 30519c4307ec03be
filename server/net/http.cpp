#include "server/net/http.h"

#include <libwebsockets.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "server/base/text.h"
#include "server/film/formats.h"
#include "server/model/mesh_file.h"
#include "server/model/size.h"
#include "server/net/hub.h"
#include "server/net/limits.h"
#include "server/net/request_checks.h"
#include "server/net/request_headers.h"
#include "server/net/server.h"

namespace clothlab::net {

namespace {

HttpAnswer plain(unsigned status, const std::string& text) {
  return {status, "text/plain; charset=utf-8", text + "\n", {}};
}

HttpAnswer no_collider() {
  return plain(404, "the scene has no mesh collider of this name; name=NAME is that of /api/scene's list");
}

HttpAnswer scene_answer(std::shared_ptr<const std::string> file) {
  return {200, "application/json", {}, {}, std::move(file)};
}
HttpAnswer shared_binary(std::shared_ptr<const std::string> bytes) {
  return {200, "application/octet-stream", {}, {{"cache-control:", "no-store"}}, std::move(bytes)};
}
HttpAnswer binary(std::string bytes) {
  return shared_binary(std::make_shared<const std::string>(std::move(bytes)));
}

/// The ending of a file of a recording that is at this path; empty: none is.
std::string recording_ending(const std::string& path) {
  const std::string start = "/api/recording";
  for (const char* ending : {".clothlab", ".html", ".glb", ".usda"})
    if (path == start + ending) return ending;
  return {};
}

/// The name of a recording's file: its scene, and the times of its first and last frame.
std::string name_of_file(const session::RecordingFacts& facts, const std::string& ending) {
  std::string name;  // as a header may have it
  for (const char letter : facts.scene.substr(0, 60)) {
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                       (letter >= '0' && letter <= '9') || letter == '-' || letter == '_' || letter == ' ';
    name += plain ? letter : '_';
  }
  const auto [from, to] = facts.times.value_or(std::pair(0.0, 0.0));
  return name + formatted(" %.2f-%.2f s", from, to) + ending;
}

/// A body that lives at least as long as the server's requests.
std::shared_ptr<const std::string> lasting(const std::string& body) {
  return {std::shared_ptr<void>(), &body};
}

HttpAnswer try_again(const std::string& why) {
  HttpAnswer refusal = plain(503, why);
  refusal.headers = {{"retry-after:", "1"}};
  return refusal;
}

HttpAnswer busy() {
  return try_again("the server has as many pictures and meshes to make as it may; ask again");
}

/// The width or height that `text` gives, a whole number in [1, most] [pixels]; 0 for any other text.
int side(const std::string& text, int most) {
  int value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failure == std::errc() && end == text.data() + text.size() && value >= 1 && value <= most ? value
                                                                                                   : 0;
}

/// While it lives, the service thread works for this address, which pays for that time.
class Served {
 public:
  Served(Hub& hub, std::string network) : hub_(hub), network_(std::move(network)) {}
  ~Served() { hub_.http_service().spend(network_, session::now_us(), thread_time_us() - since_); }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

 private:
  Hub& hub_;
  std::string network_;
  std::int64_t since_ = thread_time_us();
};

}  // namespace

HttpRequest::HttpRequest(Hub& hub, const WebFiles& files, lws* wsi, Finish finish)
    : hub_(hub),
      files_(files),
      wsi_(wsi),
      finish_(finish),
      id_(hub.next_id()),
      network_(network_of(client_address(wsi, hub.options().trusted_proxies))),
      later_(wsi, [this] {
        if (const Progress progress = answer(); progress != Progress::waits) finish_(wsi_, progress);
      }) {
  hub_.add(id_, *this);
}

HttpRequest::~HttpRequest() {
  hub_.remove_request(id_);
}

HttpRequest::Progress HttpRequest::begin(const std::string& path) {
  if (const std::optional<RequestFault> fault = request_fault(wsi_))
    return refuse(plain(fault->status, fault->why));
  if (const std::string origin = header(wsi_, WSI_TOKEN_ORIGIN);
      is_origin(origin) && origin_allowed(origin, {}, hub_.options().allow_origin))
    reader_ = origin;
  head_ = lws_hdr_total_length(wsi_, WSI_TOKEN_HEAD_URI) > 0;
  if (!head_ && lws_hdr_total_length(wsi_, WSI_TOKEN_GET_URI) <= 0) {
    HttpAnswer refusal =
        plain(405, "only GET and HEAD are answered here; changes go over the WebSocket at /ws");
    refusal.headers = {{"allow:", "GET, HEAD"}};
    return refuse(refusal);  // the request may have a body
  }
  path_ = path;
  return answer();
}

HttpRequest::Progress HttpRequest::answer() {
  const std::int64_t wait = hub_.http_service().wait(network_, session::now_us());
  if (wait > 0 && path_ != "/healthz") {  // a load balancer asks that, and must not wait for others
    lws_rx_flow_control(wsi_, 0);
    lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, making_patience);
    later_.start(std::max<std::int64_t>(wait, 2000));
    return Progress::waits;
  }
  const Served served(hub_, network_);
  if (std::optional<HttpAnswer> answer = find(path_)) return send(std::move(*answer));
  lws_rx_flow_control(wsi_, 0);
  return Progress::waits;
}

std::optional<HttpAnswer> HttpRequest::find(const std::string& path) {
  if (path == "/healthz")
    return hub_.all_sessions_beat() ? plain(200, "ok") : plain(503, "a session's thread does not answer");
  if (const std::string why = hub_.host_refusal(header(wsi_, WSI_TOKEN_HOST)); !why.empty())
    return plain(403, why);
  if (path == "/ws") return handshake_answer();
  if (path != "/metrics" && path.rfind("/api/", 0) != 0) return file(path);
  if (std::optional<HttpAnswer> why = refusal()) return why;
  return find_protected(path);
}

/// To who asks without an upgrade: why a handshake would be refused now, which browsers do not tell their
/// pages.
HttpAnswer HttpRequest::handshake_answer() const {
  std::string why;
  auto& server = *static_cast<Server*>(lws_context_user(lws_get_context(wsi_)));
  const unsigned status = server.refusal(wsi_, why);
  if (status == 503) return try_again(why);
  if (status != 0) return plain(status, why);
  HttpAnswer refusal = plain(426, "connect with a WebSocket, subprotocol clothlab.v1");
  refusal.headers = {{"upgrade:", "websocket"}};
  return refusal;
}

HttpAnswer HttpRequest::file(const std::string& path) const {
  const WebFile* file = files_.find(path);
  if (!file) return plain(404, "nothing is at " + path + "; the page is at /");
  HttpAnswer answer{200,
                    file->type,
                    {},
                    {{"etag:", file->etag}, {"cache-control:", "no-cache"}, {"vary:", "accept-encoding"}}};
  const std::string known = header(wsi_, WSI_TOKEN_HTTP_IF_NONE_MATCH);
  if (known == "*" || known.find(file->etag) != std::string::npos) {
    answer.status = 304;
    return answer;
  }
  answer.shared = lasting(file->body);
  if (file->gzipped.empty()) return answer;
  const Coding coding = preferred_coding(header(wsi_, WSI_TOKEN_HTTP_ACCEPT_ENCODING), !file->brotli.empty());
  if (coding == Coding::identity) return answer;
  answer.headers.emplace_back("content-encoding:", coding == Coding::brotli ? "br" : "gzip");
  answer.shared = lasting(coding == Coding::brotli ? file->brotli : file->gzipped);
  return answer;
}

std::optional<HttpAnswer> HttpRequest::refusal() const {
  if (!hub_.needs_token()) return std::nullopt;
  const std::string given = header(wsi_, WSI_TOKEN_HTTP_AUTHORIZATION);
  const std::string scheme = "Bearer ";
  TokenCheck verdict;
  if (given.rfind(scheme, 0) == 0)
    verdict = hub_.check_token(given.substr(scheme.size()),
                               client_address(wsi_, hub_.options().trusted_proxies), {});
  if (verdict.role != Role::none) return std::nullopt;
  if (verdict.wait == 0) {
    HttpAnswer refusal = plain(401, "send the server's token as `Authorization: Bearer TOKEN`");
    refusal.headers = {{"www-authenticate:", "Bearer"}};
    return refusal;
  }
  HttpAnswer refusal = plain(429, token_wait_message(verdict.wait));
  refusal.headers = {{"retry-after:", std::to_string(verdict.wait)}};
  return refusal;
}

std::optional<HttpAnswer> HttpRequest::find_protected(const std::string& path) {
  if (path == "/metrics")
    return HttpAnswer{
        200, "text/plain; version=0.0.4; charset=utf-8", metrics_text(hub_.metrics(), hub_.gauges()), {}};
  const std::string session = query(wsi_, "session", main_session);
  const bool mesh = path == "/api/mesh.obj", model = path == "/api/mesh.glb",
             picture = path == "/api/snapshot.png";
  const bool collider = path == "/api/collider.ply";
  const std::string recorded = recording_ending(path);
  if (!mesh && !model && !picture && !collider && recorded.empty() && path != "/api/scene")
    return plain(
        404,
        "the API has /api/scene, /api/mesh.obj, /api/mesh.glb, /api/collider.ply, /api/snapshot.png, "
        "/api/recording.clothlab, .html, .glb and .usda");
  Room* room = hub_.find_room(session);
  if (!room && hub_.elsewhere(session)) return try_again("another server has this session open; ask again");
  if (!room || !room->started())
    return plain(404,
                 "no such session is open; one opens when a page or script connects to /ws?session=NAME");
  if (path == "/api/scene") return scene_file(*room);
  // The document may have only the name of a mesh's file, so the page asks for what the server has read.
  if (collider) return collider_mesh(*room, query(wsi_, "name", ""));
  if (hub_.relays())
    return plain(404, "a relay only passes on what viewers see; ask the server that runs the session");
  if (!recorded.empty()) return recording(*room, recorded);
  using Kind = session::Export::Kind;
  if (mesh || model) return ask_session(session, {mesh ? Kind::obj : Kind::glb});
  const session::Export what{Kind::picture, side(query(wsi_, "width", "1280"), max_snapshot_side),
                             side(query(wsi_, "height", "720"), max_snapshot_side)};
  if (what.width == 0 || what.height == 0)
    return plain(400, "width and height are whole numbers from 1 to " + std::to_string(max_snapshot_side));
  return ask_session(session, what);
}

std::optional<HttpAnswer> HttpRequest::scene_file(Room& room) {
  if (const session::JsonText& file = room.scene_file()) return scene_answer(file);
  lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, making_patience);
  const auto pass_on = [&hub = hub_, id = id_, session = room.name()](
                           const std::shared_ptr<const scene::Document>& of, const session::JsonText& file) {
    if (Room* there = hub.find_room(session); there && file) there->keep_scene_file(of, file);
    if (HttpRequest* request = hub.find_request(id)) request->deliver_scene(file);
  };
  hub_.workbench().add(
      [document = room.shared_document(), pass_on]() -> Workbench::Ending {
        const auto file = std::make_shared<const std::string>(document->value.dump(2) + "\n");
        return [document, file, pass_on] { pass_on(document, file); };
      },
      [pass_on] { pass_on(nullptr, nullptr); });
  return std::nullopt;
}

void HttpRequest::deliver_scene(const session::JsonText& file) {
  const Served served(hub_, network_);
  finish_(wsi_,
          send(file ? scene_answer(file) : plain(500, "there was no memory to write the scene; ask again")));
}

std::optional<HttpAnswer> HttpRequest::collider_mesh(Room& room, const std::string& name) {
  if (hub_.relays()) {
    if (const std::shared_ptr<const std::string> known = room.relayed_collider(name))
      return shared_binary(known);
    lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, making_patience);
    room.ask_collider(name, id_);
    return std::nullopt;
  }
  std::optional<std::string> mesh = model::collider_ply(room.scene(), name);
  return mesh ? binary(std::move(*mesh)) : no_collider();
}

std::optional<HttpAnswer> HttpRequest::recording(const Room& room, const std::string& ending) {
  const session::RecordingFacts facts = room.recording();
  if (!facts.file)
    return plain(
        404, facts.state == session::RecordingFacts::State::recording
                 ? "this session is being recorded; record.stop over the WebSocket ends that"
                 : "nothing has been recorded in this session; record.start over the WebSocket does that");
  file_name_ = name_of_file(facts, ending);
  ending_ = ending;
  if (ending == ".clothlab") return shared_binary(facts.file);
  if (const clothlab::Status fits = film::check_size(ending, facts.frames, facts.vertices); !fits)
    return plain(409,
                 fits.error().text() + "; save the .clothlab, of which `clothlab record` makes the file");
  if (std::shared_ptr<const std::string> made = hub_.made_of(facts.file, ending))
    return made_of_recording(std::move(made));
  if (hub_.exports_full()) return busy();
  // A page has it in base64, and as text while it is made; beside the player, which it is written into.
  constexpr std::uint64_t player = 1 << 20;
  const film::Format* film = film::format_of(ending);
  // A text that grows takes up to twice as much, and three times while it moves.
  const std::uint64_t bytes = 3 * (film ? film->bytes(facts.frames, facts.vertices) : facts.file->size());
  if (std::optional<HttpAnswer> why = reserve(MemoryBudget::Use::downloads, bytes + player)) return why;
  lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, making_patience);
  hub_.make_of_recording(id_, facts, ending);
  return std::nullopt;
}

std::optional<HttpAnswer> HttpRequest::ask_session(const std::string& session, session::Export what) {
  if (hub_.exports_full()) return busy();
  // A picture takes up to 0.8 GB of software OpenGL, for 4096 x 4096 pixels; one at a time is made.
  constexpr std::uint64_t pixel = 48, vertex = 1000;
  const Room& room = *hub_.find_room(session);
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(what.width) * static_cast<std::uint64_t>(what.height);
  if (std::optional<HttpAnswer> why = reserve(
          MemoryBudget::Use::simulations, pixel * pixels + vertex * model::size_of(room.scene()).vertices))
    return why;
  if (!hub_.find_room(session)->capture(id_, what)) return busy();
  lws_set_timeout(wsi_, PENDING_TIMEOUT_HTTP_CONTENT, making_patience);
  return std::nullopt;
}

// Asks the socket: while nothing is read, libwebsockets does not notice that the client has gone.
bool HttpRequest::hung_up() const {
  pollfd socket{lws_get_socket_fd(wsi_), POLLRDHUP, 0};
  return poll(&socket, 1, 0) > 0 && (socket.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

std::optional<HttpAnswer> HttpRequest::reserve(MemoryBudget::Use use, std::uint64_t bytes) {
  memory_ = {};
  Result<MemoryBudget::Reservation> place = MemoryBudget::reserve(hub_.limits().scene.memory, use, bytes);
  if (!place) return try_again(place.error().text());
  memory_ = std::move(*place);
  return std::nullopt;
}

void HttpRequest::deliver(session::Exported exported) {
  const Served served(hub_, network_);
  memory_ = {};
  finish_(
      wsi_,
      exported.body
          ? send({200, exported.content_type, std::move(*exported.body), {{"cache-control:", "no-store"}}})
          : send(plain(film::format_of(exported.ending) ? 409 : 500, exported.body.error().text())));
}

void HttpRequest::deliver_made(std::shared_ptr<const std::string> file) {
  const Served served(hub_, network_);
  finish_(wsi_, send(made_of_recording(std::move(file))));
}

HttpAnswer HttpRequest::made_of_recording(std::shared_ptr<const std::string> file) const {
  const film::Format* film = film::format_of(ending_);
  return {200,
          film ? film->content_type : "text/html; charset=utf-8",
          {},
          {{"cache-control:", "no-store"}},
          std::move(file)};
}

void HttpRequest::deliver_collider(const std::shared_ptr<const std::string>& mesh) {
  const Served served(hub_, network_);
  finish_(wsi_, send(mesh ? shared_binary(mesh) : no_collider()));
}

}  // namespace clothlab::net
