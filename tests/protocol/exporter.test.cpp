// The thread that makes pictures and meshes, here with files made for the test.
#include "server/session/exporter.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <new>
#include <stdexcept>

#include "server/gl/context.h"
#include "tests/catch.h"

using namespace clothlab;
using session::Exported;
using session::Exporter;

namespace {

void await(const std::function<bool()>& happened) {
  while (!happened()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

Exported made_by(Exporter& exporter) {
  std::optional<Exported> made;
  await([&] { return (made = exporter.take()).has_value(); });
  return std::move(*made);
}

session::Moment moment_at(double time) {
  session::Moment moment;
  moment.time = time;
  return moment;
}

}  // namespace

TEST_CASE("the exporter makes one file at a time, gives way while it does, and tells of each") {
  std::atomic<bool> may_end{false};
  std::atomic<int> told{0}, nice{0};
  const auto make = [&](const session::Moment& moment, const session::Export& what) -> Result<std::string> {
    nice = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
    await([&] { return may_end.load(); });
    return std::to_string(what.width) + " at " + std::to_string(static_cast<int>(moment.time));
  };
  Exporter exporter(make, [&] { ++told; });
  CHECK(exporter.idle());
  exporter.begin(7, {session::Export::Kind::picture, 10, 20}, moment_at(1));
  CHECK_FALSE(exporter.idle());
  CHECK_FALSE(exporter.take());
  may_end = true;
  await([&] { return told == 1; });
  CHECK_FALSE(exporter.idle());
  const Exported picture = made_by(exporter);
  CHECK(exporter.idle());
  CHECK(picture.asker == 7);
  CHECK(*picture.body == "10 at 1");
  CHECK(std::string(picture.content_type) == "image/png");
  exporter.begin(8, {}, moment_at(2));
  const Exported mesh = made_by(exporter);
  CHECK(*mesh.body == "0 at 2");
  CHECK(std::string(mesh.content_type) == "text/plain; charset=utf-8");
  CHECK(nice == 10);
}

TEST_CASE("an export that cannot be made is an error, and the next one is made") {
  int count = 0;
  const auto make = [&](const session::Moment&, const session::Export&) -> Result<std::string> {
    ++count;
    if (count == 1) throw std::bad_alloc();
    if (count == 2) throw std::runtime_error("the file fell over");
    if (count == 3) return Error{"export", "it would not", "ask again"};
    return std::string("made");
  };
  Exporter exporter(make, [] {});
  for (const char* why : {"not enough memory", "the file fell over", "it would not"}) {
    exporter.begin(1, {session::Export::Kind::picture, 10, 10}, {});
    CHECK(made_by(exporter).body.error().text().find(why) != std::string::npos);
  }
  exporter.begin(1, {session::Export::Kind::picture, 10, 10}, {});
  CHECK(*made_by(exporter).body == "made");
}

TEST_CASE("an exporter that ends finishes what it makes") {
  std::atomic<bool> begun{false}, ended{false};
  const auto make = [&](const session::Moment&, const session::Export&) -> Result<std::string> {
    begun = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ended = true;
    return std::string("made");
  };
  {
    Exporter exporter(make, [] {});
    exporter.begin(1, {session::Export::Kind::picture, 10, 10}, {});
    await([&] { return begun.load(); });
  }
  CHECK(ended);
}

TEST_CASE("a picture or mesh of a moment needs no session") {
  Result<scene::Document> document = scene::load_preset("seed");
  REQUIRE(document);
  session::Moment moment = moment_at(0.5);
  moment.positions.assign(625, glm::vec3(0));
  for (std::size_t i = 0; i < 625; ++i) moment.positions[i].x = 0.01f * static_cast<float>(i % 25);
  moment.document = std::make_shared<const scene::Document>(std::move(*document));
  const Result<std::string> mesh = session::make_export(std::nullopt, moment, {});
  REQUIRE(mesh);
  CHECK(mesh->find("t = 0.5 s") != std::string::npos);
  CHECK(mesh->find("\nv 0.24 0 0\n") != std::string::npos);
  std::thread([&] {
    const Result<std::string> picture =
        session::make_export(std::nullopt, moment, {session::Export::Kind::picture, 64, 48});
    REQUIRE(picture);
    CHECK(picture->substr(1, 3) == "PNG");
  }).join();
}
