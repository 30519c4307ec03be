// The lab's cache: what it finds again, what it does not, and how it handles a damaged folder.
#include "server/lab/cache.h"

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>

#include "server/lab/exports.h"
#include "server/scene/method.h"
#include "tests/catch.h"
#include "tests/lab_outcomes.h"

using namespace clothlab;
using namespace clothlab::lab;
namespace fs = std::filesystem;

namespace {

/// A folder for one test, removed with it.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("clothlab-cache-" + std::to_string(getpid()));
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
  std::vector<fs::path> files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
    return files;
  }
};

scene::Document seed(const std::string& assignment = "") {
  const scene::Document document = *scene::load("seed");
  return assignment.empty() ? document : *scene::set_value(document, assignment);
}

std::string hash(const scene::Document& document, const Job& job = ChartRequest{},
                 const std::string& renderer = "llvmpipe") {
  return cache_key(document, job, renderer).hash;
}

/// Has one mesh, of any name: a square of this height.
struct Square : scene::Assets {
  explicit Square(double height) {
    mesh::Mesh square;
    square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, height, 0}, {0, height, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    square.vertex_of = {0, 1, 2, 3};
    shared = std::make_shared<const mesh::Mesh>(std::move(square));
  }
  Result<scene::SharedMesh> mesh(const std::string&, const mesh::Reading&) const override { return shared; }
  scene::SharedMesh shared;
};

CacheKey key(int number) {
  return {std::string(31, '0') + std::to_string(number), "seed"};
}

}  // namespace

TEST_CASE("another mesh under the same name is another scene to the cache") {
  const json value = json::parse(R"({"version": 1, "cloths": [{"mesh": {"obj": "a.obj"}}]})");
  const auto of = [&](double height) {
    return hash(*scene::validate(value, std::make_shared<Square>(height)));
  };
  CHECK(of(1) == of(1));
  CHECK(of(1) != of(2));
}

TEST_CASE("every kind of result comes back from its JSON as it was") {
  for (const Outcome& outcome :
       {Outcome(tests::made_up_chart()), Outcome(tests::made_up_map()), Outcome(tests::made_up_choice()),
        Outcome(tests::made_up_simplification())}) {
    const json written = to_json(outcome);
    const Result<Outcome> read = from_json(written);
    REQUIRE(read);
    CHECK(read->index() == outcome.index());
    CHECK(to_json(*read) == written);
    CHECK(svg(*read) == svg(outcome));
  }
}

TEST_CASE("JSON that lacks anything of a result is refused, whatever it lacks") {
  const json whole = to_json(tests::made_up_choice());
  for (const auto& [name, value] : whole.items()) {
    if (name == "patch") continue;  // follows from the setting
    json lacking = whole;
    lacking.erase(name);
    CHECK_FALSE(from_json(lacking));
    lacking[name] = json::array({json::object()});
    CHECK_FALSE(from_json(lacking));
  }
  for (const json& other : {json(), json(3), json::array(), json{{"kind", "chart"}}, json{{"kind", "poem"}}})
    CHECK_FALSE(from_json(other));
}

TEST_CASE("a key depends on all that moves the cloth, the job and the device, and on no name or colour") {
  const std::string own = hash(seed());
  CHECK(own.size() == 32);
  CHECK(hash(seed()) == own);
  for (const char* looks :
       {"/name=other", "/cloths/0/name=sheet", "/cloths/0/color=#00ff00", "/cloths/0/texture=plain"})
    CHECK(hash(seed(looks)) == own);
  for (const char* matters : {"/solver/dt=0.0009", "/solver/method=verlet", "/gravity/1=-9.7",
                              "/cloths/0/material/bend=1999", "/self_collision/thickness=0.011"})
    CHECK(hash(seed(matters)) != own);
  CHECK(hash(seed(), ChartRequest{}, "a GPU") != own);
  CHECK(hash(seed(), ChartRequest{{}, {}, 2.0, 120}) != own);
  CHECK(hash(seed(), ChartRequest{{}, {2}, {}, 120}) != own);
  CHECK(hash(seed(), SimplifyRequest{}) != own);
  CHECK(hash(seed(), ChooseRequest{1e-3, {}, {}}) != hash(seed(), ChooseRequest{1e-2, {}, {}}));
  // Naming all methods, in any order, is the same as naming none.
  ChartRequest all{{scene::methods.rbegin(), scene::methods.rend()}, {}, {}, 120};
  CHECK(hash(seed(), all) == own);
}

TEST_CASE("a result is found by the same program and by the next one, under the name the scene has now") {
  const Folder folder;
  Cache cache(folder.path);
  const CacheKey here = cache_key(seed(), ChartRequest{}, "llvmpipe");
  CHECK_FALSE(cache.find(here));
  cache.keep(here, tests::made_up_chart());
  Cache next(folder.path);
  for (Cache* any : {&cache, &next}) {
    const std::optional<Outcome> found = any->find(here);
    REQUIRE(found);
    CHECK(to_json(*found) == to_json(tests::made_up_chart()));
  }
  const std::optional<Outcome> renamed =
      next.find(cache_key(seed("/name=other"), ChartRequest{}, "llvmpipe"));
  REQUIRE(renamed);
  CHECK(std::get<Chart>(*renamed).scene == "other");
  CHECK(folder.files().size() == 1);
}

TEST_CASE("an incomplete result is not kept") {
  const Folder folder;
  Cache cache(folder.path);
  Chart chart = tests::made_up_chart();
  chart.complete = false;
  cache.keep(key(1), chart);
  CHECK_FALSE(cache.find(key(1)));
}

TEST_CASE("a damaged or foreign file is as good as none, and is replaced") {
  const Folder folder;
  Cache(folder.path).keep(key(1), tests::made_up_chart());
  REQUIRE(folder.files().size() == 1);
  const fs::path file = folder.files()[0];
  const std::string whole = [&] {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }();
  const std::string other_key =
      // an entry under the name of another one
      std::string(whole).replace(whole.find("\"0000"), 5, "\"1111");
  for (const std::string& text :
       {whole.substr(0, whole.size() / 2), std::string(), std::string("[[[["), std::string("{}"),
        std::string(100000, '['), std::string(R"({"key": 3, "result": {}})"), other_key}) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
    Cache cache(folder.path);
    CHECK_FALSE(cache.find(key(1)));
    cache.keep(key(1), tests::made_up_chart());
    CHECK(Cache(folder.path).find(key(1)));
  }
}

TEST_CASE("a folder that cannot be made leaves the memory, and no error") {
  const Folder folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "file") << "in the way";
  for (const fs::path& bad : {folder.path / "file" / "below", fs::path("/proc/nowhere"), fs::path()}) {
    Cache cache(bad);
    cache.keep(key(1), tests::made_up_chart());
    CHECK(cache.find(key(1)));
    CHECK_FALSE(Cache(bad).find(key(1)));
  }
}

TEST_CASE("neither memory nor disk grows beyond its limit: the oldest goes first") {
  const Folder folder;
  const std::size_t bytes = to_json(tests::made_up_chart()).dump().size();
  Cache cache(folder.path, {2, 7 * bytes / 2});  // holds three files with their keys
  for (int number = 1; number <= 6; ++number) {
    cache.keep(key(number), tests::made_up_chart());
    // Files of the same moment would have no order.
    for (const fs::path& file : folder.files())
      if (file.filename().string().starts_with(key(number).hash))
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(10 - number));
  }
  CHECK(folder.files().size() == 3);
  Cache next(folder.path);
  for (int number = 1; number <= 6; ++number) CHECK(next.find(key(number)).has_value() == (number > 3));
  Cache memory({}, {2, 0});
  for (int number = 1; number <= 3; ++number) memory.keep(key(number), tests::made_up_chart());
  CHECK_FALSE(memory.find(key(1)));
  CHECK((memory.find(key(2)) && memory.find(key(3))));
}
