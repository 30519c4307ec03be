// Messages to the server, one per line, from two clients in turn: from the bytes as libwebsockets delivers
// them to the answer as it would be written. Every request gets one answer with its id, a notification gets
// none, and the connection stays open.
//
// The first character of the input sets the clients up (bit 0: a token is asked for; bit 1: the second client
// is in another session). A line may begin with ">" (the second client sends it) or "%" (as a binary
// message); "\x1f" within a line ends a fragment.
#include <algorithm>
#include <memory>
#include <set>

#include "server/base/log.h"
#include "server/net/client.h"
#include "server/net/hub.h"
#include "tests/fuzz/document.h"
#include "tests/fuzz/no_machine.h"

using namespace clothlab;
using net::json;

namespace {

class Peer {
 public:
  Peer(net::Hub& hub, const std::string& session)
      : wsi_(fuzz::connect()), client_(std::make_unique<net::Client>(hub, wsi_, session)) {}
  ~Peer() {
    client_.reset();
    fuzz::disconnect(wsi_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void say(const std::string& line, bool binary) {
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find('\x1f', begin), line.size());
      fuzz::set_arrival({begin == 0, end == line.size(), binary});
      client_->receive(line.data() + begin, end - begin);
      begin = end + 1;
    }
  }

  /// Reads all messages that wait to be sent, each a whole one.
  std::vector<json> hear() {
    std::size_t before = 0;
    std::vector<json> heard;
    do {
      before = heard.size();
      client_->writeable();
      for (const std::string& text : fuzz::take_sent(wsi_)) heard.push_back(parsed(text));
    } while (heard.size() > before);
    return heard;
  }

  bool closed() const { return fuzz::close_was_said(wsi_); }

 private:
  static json parsed(const std::string& text) {
    json message = json::parse(text, nullptr, false);
    fuzz::require(message.is_object() && message.value("jsonrpc", "") == "2.0",
                  "the server sends JSON-RPC 2.0", text);
    return message;
  }

  lws* wsi_;
  std::unique_ptr<net::Client> client_;
};

void require_error(const json& error, const std::string& text) {
  fuzz::require(error.contains("code") && error["code"].is_number_integer() && error.contains("message") &&
                    !error["message"].get<std::string>().empty(),
                "an error has a code and a message", text);
  if (error["code"] != net::error_invalid_params) return;
  fuzz::require(error.contains("data") && error["data"]["path"].is_string() &&
                    error["data"]["found"].is_string() &&
                    !error["data"]["allowed"].get<std::string>().empty(),
                "invalid parameters are named, with what is allowed", text);
}

/// The id that an answer to the message must have: null if the id could not be read, nothing if no answer is
/// due.
std::optional<json> answer_wanted(const std::string& line, bool binary) {
  if (binary) return json(nullptr);
  const std::variant<net::Request, net::BadRequest> read = net::parse_request(line);
  if (const auto* bad = std::get_if<net::BadRequest>(&read)) return bad->id;
  return std::get<net::Request>(read).id;
}

void pump(net::Hub& hub) {
  do hub.pump();
  while (fuzz::answer_commands());
  hub.pump();
}

/// Number of answers among the messages `heard`; each must be to `wanted`.
int answers(const std::vector<json>& heard, const std::optional<json>& wanted, const std::string& line) {
  int count = 0;
  for (const json& message : heard) {
    if (message.contains("method")) continue;
    ++count;
    fuzz::require(wanted && message["id"] == *wanted, "an answer has the request's id", line);
    fuzz::require(message.contains("result") != message.contains("error"),
                  "an answer is a result or an error", line);
    if (message.contains("error")) require_error(message["error"], message.dump());
  }
  return count;
}

net::Options options(bool token) {
  static const scene::Document document = *scene::load_preset("hanging-strip");
  net::Options options;
  options.document = document;
  if (token) {
    options.token = std::string("t");
    options.view_token = std::string("v");
  }
  return options;
}

void without_fragments(std::string& line) {
  line.erase(std::remove(line.begin(), line.end(), '\x1f'), line.end());
}

void converse(net::Hub& hub, Peer& first, Peer& second, std::string_view rest) {
  for (int messages = 0; !rest.empty() && messages < 24; ++messages) {
    std::string line = fuzz::next_line(rest);
    const auto marked = [&line](char mark) {
      const bool found = !line.empty() && line[0] == mark;
      if (found) line.erase(0, 1);
      return found;
    };
    const bool by_second = marked('>'), binary = marked('%');
    Peer& speaker = by_second ? second : first;
    Peer& listener = by_second ? first : second;
    speaker.say(line, binary);
    without_fragments(line);
    pump(hub);
    const std::optional<json> wanted = answer_wanted(line, binary);
    const int count = answers(speaker.hear(), wanted, line);
    fuzz::require(count == (wanted ? 1 : 0), "a request has one answer, a notification none", line);
    fuzz::require(answers(listener.hear(), std::nullopt, line) == 0, "nobody hears another's answer", line);
    fuzz::require(!first.closed() && !second.closed(), "a bad message does not end the connection", line);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  set_log_level(LogLevel::error);
  if (size == 0 || size > scene::max_json_bytes) return 0;
  const int setup = data[0];
  net::Hub hub(options(setup & 1), [] {});
  {
    Peer first(hub, "main"), second(hub, setup & 2 ? "other" : "main");
    pump(hub);
    answers(first.hear(), std::nullopt, "greeting");
    answers(second.hear(), std::nullopt, "greeting");
    const std::string text = fuzz::text_of(data + 1, size - 1);
    converse(hub, first, second, text);
    for (Peer* peer : {&first, &second}) {
      peer->say(R"({"jsonrpc":"2.0","id":"last","method":"auth","params":{"token":"t"}})", false);
      pump(hub);
      const std::vector<json> heard = peer->hear();
      fuzz::require(answers(heard, "last", "auth") == 1, "the server still answers");
    }
  }
  hub.stop_sessions();
  return 0;
}
