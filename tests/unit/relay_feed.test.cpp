// A session as a relay gets it from its server, over a bus in memory that can lose messages.
#include <algorithm>
#include <iterator>
#include <memory>
#include <set>

#include "server/net/publisher.h"
#include "server/relay/feed.h"
#include "server/scene/document.h"
#include "tests/catch.h"

namespace clothlab {

namespace {

using bus::Keep;
using nlohmann::json;
using stream::Encoding;

constexpr std::int64_t second = 1'000'000;

class BusInMemory final : public bus::Bus {
 public:
  std::set<std::string> subscribed;
  std::vector<bus::Outgoing> sent;

  void send(bus::Outgoing message, Keep) override { sent.push_back(std::move(message)); }
  void subscribe(const std::string& subject, Keep) override { subscribed.insert(subject); }
  void unsubscribe(const std::string& subject) override { subscribed.erase(subject); }
  void take(std::vector<bus::Message>& out) override { out.clear(); }
  bus::Counts counts() const override { return {}; }
  void close() override {}

  std::vector<bus::Message> take_sent() {
    std::vector<bus::Message> messages;
    for (const bus::Outgoing& each : sent)
      messages.push_back({each.subject, each.reply, each.note,
                          std::vector<std::uint8_t>(each.bytes.data, each.bytes.data + each.bytes.size),
                          false});
    sent.clear();
    return messages;
  }
};

stream::SharedMessage message(stream::MessageKind kind, std::uint32_t topology, std::uint32_t sequence,
                              std::vector<std::uint8_t> payload = {1, 2, 3}) {
  auto made = std::make_shared<stream::Message>();
  made->header.kind = kind;
  made->header.encoding = kind == stream::MessageKind::frame ? Encoding::q16 : Encoding::f32;
  made->header.topology_revision = topology;
  made->header.sequence = sequence;
  made->header.payload_bytes = static_cast<std::uint32_t>(payload.size());
  made->bytes.resize(stream::front_room + stream::header_bytes);
  stream::write_header(made->header, made->bytes.data() + stream::front_room);
  made->bytes.insert(made->bytes.end(), payload.begin(), payload.end());
  return made;
}

/// A server's session and a relay of it.
struct Pair {
  std::shared_ptr<MemoryBudget> budget{};
  BusInMemory bus{};
  net::Publisher publisher{bus, "main", "origin-1"};
  relay::Feed feed{bus,
                   "main",
                   "r",
                   [this](std::uint64_t asker, const relay::Feed::ColliderMesh& mesh) {
                     delivered.emplace_back(asker, mesh ? *mesh : "none");
                   },
                   [] {},
                   budget};
  std::vector<std::pair<std::uint64_t, std::string>> delivered{};
  json document{{"name", "one"}, {"gravity", 1}}, history = json::object();
  std::uint64_t revision = 7;
  stream::SharedMessage topology = message(stream::MessageKind::topology, 1, 0);
  std::int64_t now = session::now_us();
  std::vector<session::Event> events{};

  /// Lets a second pass: the relay says what it wants, and the server answers.
  void pass(const std::string& origin = "origin-1") {
    now += second;
    feed.pump(now);
    for (const bus::Message& asked : bus.take_sent()) {
      if (asked.subject != "clothlab.main.want") continue;
      const auto want =
          relay::read_want({reinterpret_cast<const char*>(asked.bytes.data()), asked.bytes.size()});
      REQUIRE(want);
      net::Publisher answering(bus, "main", origin);
      answering.answer(*want, asked.reply, {"llvmpipe", document, revision, history, topology});
      publisher.audience().heard(*want, now);
    }
    arrive();
  }
  /// Lets the relay get what the server has sent.
  void arrive() {
    for (const bus::Message& each : bus.take_sent()) feed.receive(each, now);
    take_events();
  }
  void take_events() {
    std::vector<session::Event> more;
    feed.exchange().take_events(more);
    std::move(more.begin(), more.end(), std::back_inserter(events));
  }
  void want_frames() {
    session::Demand demand;
    demand.rate[stream::Form(Encoding::q16).index()] = 60;
    feed.exchange().post({{}, session::Watchers{1}});
    feed.exchange().post({{}, demand});
    pass();
  }
  template <class T>
  std::vector<T> of() const {
    std::vector<T> found;
    for (const session::Event& event : events)
      if (const T* each = std::get_if<T>(&event)) found.push_back(*each);
    return found;
  }
  void say(const char* method, const json& params) {
    publisher.text(net::make_text(net::notification_text(method, params)));
  }
  std::uint32_t shown() const { return feed.exchange().frame(Encoding::q16)->header.sequence; }
};

}  // namespace

TEST_CASE("a relay's session starts with the server's scene and topology, asked for once") {
  Pair pair;
  pair.pass();
  REQUIRE(pair.of<session::Started>().size() == 1);
  CHECK(pair.of<session::Started>()[0].renderer == "llvmpipe");
  CHECK(pair.of<session::SceneChanged>()[0].document->value == pair.document);
  CHECK(pair.of<session::SceneChanged>()[0].revision == 7);
  CHECK(pair.of<session::TopologyChanged>().size() == 1);
  pair.events.clear();
  pair.pass();
  CHECK(pair.events.empty());
}

TEST_CASE("frames come under numbers that rise, also from a server that counts anew") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  CHECK(pair.bus.subscribed.contains("clothlab.main.q16"));
  pair.publisher.frame(message(stream::MessageKind::frame, 1, 500));
  pair.arrive();
  const std::uint32_t first = pair.shown();
  pair.publisher.frame(message(stream::MessageKind::frame, 1, 510));
  pair.arrive();
  CHECK(pair.shown() == first + 10);
  pair.topology = message(stream::MessageKind::topology, 1, 0, {9});  // of another mesh, and the same number
  pair.document["name"] = "two";
  pair.revision = 1;
  pair.pass("origin-2");
  CHECK(!pair.feed.exchange().frame(Encoding::q16));  // of the mesh before
  pair.publisher.frame(message(stream::MessageKind::frame, 1, 3));
  pair.arrive();
  CHECK(pair.shown() > first + 10);
  const auto topologies = pair.of<session::TopologyChanged>();
  REQUIRE(topologies.size() == 2);
  CHECK(topologies[1].message->header.topology_revision ==
        topologies[0].message->header.topology_revision + 1);
  CHECK(pair.feed.exchange().frame(Encoding::q16)->header.topology_revision ==
        topologies[1].message->header.topology_revision);
  CHECK(pair.of<session::SceneChanged>().back().document->value.at("name") == "two");
  CHECK(!pair.of<session::SceneChanged>().back().told);
}

TEST_CASE("a status tells of the topology under the revision that it has here") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.topology = message(stream::MessageKind::topology, 1, 0, {9});
  pair.pass("origin-2");
  const auto told_of = [&](int theirs) {
    pair.events.clear();
    pair.say("sim.status", {{"time", 2.5}, {"renumbered", {{"topology_revision", theirs}, {"cloths", {0}}}}});
    pair.arrive();
    const auto told = pair.of<session::Told>();
    REQUIRE(told.size() == 1);
    CHECK(told[0].status);
    const json params = json::parse(told[0].text).at("params");
    CHECK(params.at("time") == 2.5);
    CHECK(params.at("renumbered").at("cloths") == json{0});
    return params.at("renumbered").at("topology_revision").get<int>();
  };
  CHECK(told_of(1) == 2);  // the second one here
  CHECK(told_of(2) == 0);  // one that is not here
}

TEST_CASE("a frame of a mesh that the relay does not know is not shown, and the relay asks at once") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.topology = message(stream::MessageKind::topology, 2, 0, {9});  // its message was lost
  pair.publisher.frame(message(stream::MessageKind::frame, 2, 5));
  pair.arrive();
  CHECK(!pair.feed.exchange().frame(Encoding::q16));
  pair.now += second / 2;
  pair.feed.pump(pair.now);
  CHECK(pair.bus.sent.size() == 1);
}

TEST_CASE(
    "a change is passed on at once, and the next answer brings the document with the server's defaults, "
    "silently") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.events.clear();
  pair.document = {{"name", "one"}, {"gravity", "the default"}};
  pair.revision = 8;
  pair.say("scene.changed", {{"revision", 8}, {"patch", {{"gravity", nullptr}}}, {"by", 3}});
  pair.arrive();
  REQUIRE(pair.of<session::SceneChanged>().size() == 1);
  CHECK(pair.of<session::SceneChanged>()[0].patch == json{{"gravity", nullptr}});
  CHECK(pair.of<session::SceneChanged>()[0].by == 3);
  pair.pass();
  REQUIRE(pair.of<session::SceneChanged>().size() == 2);
  CHECK(pair.of<session::SceneChanged>()[1].told);
  CHECK(pair.of<session::SceneChanged>()[1].document->value == pair.document);
  pair.events.clear();
  pair.pass();
  CHECK(pair.events.empty());
}

TEST_CASE("after a change that was lost the whole scene is told, and one that comes twice counts once") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.events.clear();
  pair.document["gravity"] = 3;
  pair.revision = 9;
  pair.say("scene.changed",
           {{"revision", 9}, {"patch", {{"gravity", 3}}}, {"by", 0}});  // that of 8 never comes
  pair.arrive();
  CHECK(pair.events.empty());
  pair.pass();
  REQUIRE(pair.of<session::SceneChanged>().size() == 1);
  CHECK(!pair.of<session::SceneChanged>()[0].told);
  CHECK(!pair.of<session::SceneChanged>()[0].patch);
  CHECK(pair.of<session::SceneChanged>()[0].document->value == pair.document);
  pair.say("scene.changed", {{"revision", 9}, {"patch", {{"gravity", 3}}}, {"by", 0}});
  pair.arrive();
  CHECK(pair.of<session::SceneChanged>().size() == 1);
}

TEST_CASE("a change that would be much work, or too large or deep, is asked for as a whole instead of made") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  json doubled = json::array(), deep = json::array();
  for (int i = 0; i < 30; ++i)
    doubled.push_back({{"op", "copy"}, {"from", ""}, {"path", "/a" + std::to_string(i)}});
  std::string path;
  for (int i = 0; i < 40; ++i)
    deep.push_back({{"op", "add"}, {"path", path += "/a"}, {"value", json::object()}});
  json long_text{{"a", std::string(scene::max_document_bytes, 'x')}};
  json nested = 1;
  for (std::size_t i = 0; i <= scene::max_json_depth; ++i) nested = json{{"a", nested}};
  for (const json& patch : {doubled, deep, long_text, nested}) {
    INFO(patch.dump().substr(0, 80));
    pair.events.clear();
    pair.say("scene.changed", {{"revision", pair.revision + 1}, {"patch", patch}, {"by", 3}});
    pair.arrive();
    CHECK(pair.events.empty());
    pair.document["gravity"] = ++pair.revision;
    pair.pass();
    REQUIRE(pair.of<session::SceneChanged>().size() == 1);
    CHECK(pair.of<session::SceneChanged>()[0].document->value == pair.document);
    CHECK(pair.of<session::SceneChanged>()[0].revision == pair.revision);
  }
}

TEST_CASE("a document that no server has is not shown") {
  Pair pair;
  pair.pass();
  pair.events.clear();
  pair.document["a"] = std::string(scene::max_document_bytes, 'x');
  ++pair.revision;
  pair.pass();
  CHECK(pair.of<session::SceneChanged>().empty());
}

TEST_CASE(
    "what a relay keeps of a session is reserved first; what does not fit is dropped, and viewers are told") {
  const auto budget = MemoryBudget::of(MemoryBudget::least_bytes);
  const std::uint64_t all = budget->left(MemoryBudget::Use::simulations);
  const auto leave = [&](std::uint64_t bytes) {
    return MemoryBudget::reserve(budget, MemoryBudget::Use::simulations,
                                 budget->left(MemoryBudget::Use::simulations) - bytes);
  };
  const auto large = [&](stream::MessageKind kind, std::uint32_t topology, std::uint32_t sequence) {
    return message(kind, topology, sequence, std::vector<std::uint8_t>(1 << 20));
  };
  {
    Pair pair{budget};
    pair.pass();
    pair.want_frames();
    REQUIRE(pair.of<session::Started>().size() == 1);
    const auto others = leave(1 << 20);
    REQUIRE(others);
    pair.publisher.frame(message(stream::MessageKind::frame, 1, 5));
    pair.arrive();
    const std::uint32_t shown = pair.shown();
    for (std::uint32_t sequence : {6u, 7u})
      pair.publisher.frame(large(stream::MessageKind::frame, 1, sequence));
    pair.topology = large(stream::MessageKind::topology, 2, 0);
    pair.publisher.topology(pair.topology);
    pair.arrive();
    CHECK(pair.shown() == shown);
    CHECK(pair.of<session::TopologyChanged>().size() == 1);
    REQUIRE(pair.of<session::Notice>().size() == 1);
    CHECK(pair.of<session::Notice>()[0].text.find("no memory for all of session main") != std::string::npos);
    CHECK(pair.of<session::Failed>().empty());
  }
  CHECK(budget->left(MemoryBudget::Use::simulations) == all);
  const auto others = leave(1000);
  REQUIRE(others);
  Pair pair{budget};
  pair.topology = large(stream::MessageKind::topology, 1, 0);
  pair.pass();
  CHECK(pair.of<session::Started>().empty());
  REQUIRE(pair.of<session::Failed>().size() == 1);
  CHECK(pair.of<session::Failed>()[0].error.remedy == "a larger --max-memory");
}

TEST_CASE("messages that are none of this protocol change nothing") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.events.clear();
  const std::vector<std::string> wrong{
      "",
      "{",
      "[]",
      "{}",
      R"({"method":"scene","params":{}})",
      R"({"method":"scene.changed","params":{"revision":8,"patch":[{"op":"x"}]}})",
      R"({"method":7,"params":{}})",
      R"({"method":"scene","params":)" + std::string(100000, '[') + std::string(100000, ']') + "}",
      std::string(100, '\x02'),
      std::string(64, '\1')};
  for (const std::string& text : wrong)
    for (const char* subject : {"text", "topology", "q16", "for.r", "elsewhere"})
      pair.feed.receive({relay::subject("main", subject), "", "", {text.begin(), text.end()}, false},
                        pair.now);
  pair.feed.receive({relay::subject("main", "for.r"), "", "collider \"x", {1}, false}, pair.now);
  pair.take_events();
  CHECK(pair.events.empty());
  CHECK(pair.delivered.empty());
}

TEST_CASE(
    "silence of the server is told once, and its end, and a session that nobody has open fails at once") {
  Pair pair;
  pair.pass();
  pair.events.clear();
  for (int i = 0; i < 10; ++i) {
    pair.feed.pump(pair.now += second);
    pair.bus.take_sent();
  }
  pair.take_events();
  REQUIRE(pair.of<session::Notice>().size() == 1);
  CHECK(pair.of<session::Notice>()[0].text.find("does not answer") != std::string::npos);
  pair.pass();
  CHECK(pair.of<session::Notice>().back().text == "the session's server answers again");
  Pair other;
  other.feed.receive({relay::answer_subject("main", "r"), "", "", {}, true}, other.now);
  other.take_events();
  REQUIRE(other.of<session::Failed>().size() == 1);
  Pair silent;
  for (int i = 0; i < 7; ++i) silent.feed.pump(silent.now += second);
  silent.take_events();
  CHECK(silent.of<session::Failed>().size() == 1);
}

TEST_CASE("two servers with one session on a bus are told once, a server that was started again is not") {
  Pair pair;
  for (const char* origin : {"origin-1", "origin-2", "origin-2", "origin-2"}) pair.pass(origin);
  CHECK(pair.of<session::Notice>().empty());
  for (const char* origin : {"origin-1", "origin-2", "origin-1"}) pair.pass(origin);
  REQUIRE(pair.of<session::Notice>().size() == 1);
  CHECK(pair.of<session::Notice>()[0].text.find("two servers publish the session main") == 0);
}

TEST_CASE("the mesh of a collider is asked for once and kept until the colliders change") {
  Pair pair;
  pair.pass();
  pair.want_frames();
  pair.feed.ask_collider("a\nb", 1);
  pair.feed.ask_collider("a\nb", 2);
  const std::vector<bus::Message> asked = pair.bus.take_sent();
  REQUIRE(asked.size() == 1);
  pair.publisher.answer_collider(std::string(asked[0].bytes.begin(), asked[0].bytes.end()), asked[0].reply,
                                 "ply");
  pair.arrive();
  CHECK(pair.delivered == std::vector<std::pair<std::uint64_t, std::string>>{{1, "ply"}, {2, "ply"}});
  CHECK(*pair.feed.collider("a\nb") == "ply");
  pair.say("scene.changed", {{"revision", 8}, {"patch", {{"gravity", 2}}}});
  pair.arrive();
  CHECK(pair.feed.collider("a\nb") != nullptr);
  pair.say("scene.changed", {{"revision", 9}, {"patch", {{"colliders", json::array({1})}}}});
  pair.arrive();
  CHECK(pair.feed.collider("a\nb") == nullptr);
  pair.feed.ask_collider("none", 3);
  for (const bus::Message& each : pair.bus.take_sent())
    if (each.subject == "clothlab.main.collider") pair.publisher.answer_collider("none", each.reply, "");
  pair.arrive();
  CHECK(pair.delivered.back() == std::pair<std::uint64_t, std::string>{3, "none"});
}

TEST_CASE("a relay that leaves says so, and subscribes to nothing any more") {
  BusInMemory bus;
  {
    relay::Feed feed(
        bus, "main", "r", [](std::uint64_t, const relay::Feed::ColliderMesh&) {}, [] {});
    session::Demand demand;
    demand.rate[0] = 1;
    feed.exchange().post({{}, demand});
    feed.pump(session::now_us());
    CHECK(bus.subscribed.size() == 4);
    bus.sent.clear();
  }
  CHECK(bus.subscribed.empty());
  const std::vector<bus::Message> last = bus.take_sent();
  REQUIRE(last.size() == 1);
  relay::Audience audience;
  audience.heard(
      *relay::read_want({reinterpret_cast<const char*>(last[0].bytes.data()), last[0].bytes.size()}), 0);
  CHECK(audience.empty());
}

}  // namespace clothlab
