// The memory of a server as one bound: what is reserved and given back, its shares, and where the bound comes
// from.
#include "server/base/memory_budget.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "server/base/memory_limit.h"
#include "tests/catch.h"

using namespace clothlab;
using Use = MemoryBudget::Use;

namespace {

constexpr std::uint64_t gigabyte = 1'000'000'000, beside = 2 * gigabyte;  // beside what the process takes

std::shared_ptr<MemoryBudget> two_gigabytes() {
  return MemoryBudget::of(MemoryBudget::process_bytes + beside);
}

/// A folder of control groups, with files as given.
struct Groups {
  std::filesystem::path root;
  Groups() {
    std::string form = (std::filesystem::temp_directory_path() / "clothlab-cgroup-XXXXXX").string();
    root = mkdtemp(form.data());
  }
  ~Groups() { std::filesystem::remove_all(root); }
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((root / file).parent_path());
    std::ofstream(root / file) << text << "\n";
  }
};

}  // namespace

TEST_CASE(
    "memory is refused beyond the total, with what is needed, left and allowed, and is there again when "
    "given back") {
  const std::shared_ptr<MemoryBudget> budget = two_gigabytes();
  auto scene = MemoryBudget::reserve(budget, Use::simulations, 1'500'000'000);
  REQUIRE(scene);
  const auto refused = MemoryBudget::reserve(budget, Use::simulations, 600'000'000);
  REQUIRE(!refused);
  CHECK(refused.error().what == "600 MB for simulations, where 300 MB are left");
  CHECK(refused.error().remedy == "at most 1.80 GB of them, in a server of 2.12 GB (--max-memory)");
  CHECK(budget->used(Use::simulations) == 1'500'000'000);
  {
    const auto small = MemoryBudget::reserve(budget, Use::simulations, 300'000'000);
    CHECK(small);
  }
  *scene = MemoryBudget::Reservation();
  CHECK(budget->used() == MemoryBudget::process_bytes);
  CHECK(MemoryBudget::reserve(budget, Use::simulations, 600'000'000));
}

TEST_CASE("no use of memory takes more than its share, nor all uses together more than the total") {
  const std::shared_ptr<MemoryBudget> budget = two_gigabytes();
  for (const auto& [use, share] :
       {std::pair{Use::simulations, beside / 10 * 9}, std::pair{Use::timelines, beside / 4},
        std::pair{Use::recordings, beside / 4}, std::pair{Use::downloads, beside / 8}}) {
    CHECK(budget->share(use) == share);
    CHECK(MemoryBudget::reserve(budget, use, share));
    CHECK(!MemoryBudget::reserve(budget, use, share + 1));
  }
  const auto scenes = MemoryBudget::reserve(budget, Use::simulations, beside / 10 * 9);
  CHECK(MemoryBudget::reserve(budget, Use::recordings, beside / 10));
  CHECK(!MemoryBudget::reserve(budget, Use::recordings, beside / 10 + 1));
}

TEST_CASE("a reservation grows as far as there is place, and stays as it was where there is none") {
  const std::shared_ptr<MemoryBudget> budget = two_gigabytes();
  auto recording = MemoryBudget::reserve(budget, Use::recordings, 1000);
  CHECK(recording->resize(beside / 4));
  CHECK(!recording->resize(beside / 4 + 1));
  CHECK(recording->bytes() == beside / 4);
  CHECK(recording->resize(10));
  MemoryBudget::Reservation moved = std::move(*recording);
  CHECK(budget->used(Use::recordings) == 10);
}

TEST_CASE("without a budget memory is not bounded") {
  CHECK(MemoryBudget::reserve(nullptr, Use::simulations, std::uint64_t{1} << 60));
}

TEST_CASE("the limit of memory is the least of a control group and those above it, of either version") {
  const Groups two;
  CHECK(!cgroup_memory_limit("0::/pod/server\n", two.root));
  two.write("pod/server/memory.max", "max");
  CHECK(!cgroup_memory_limit("0::/pod/server\n", two.root));
  two.write("pod/memory.max", "2147483648");
  CHECK(cgroup_memory_limit("0::/pod/server\n", two.root) == 2147483648u);
  two.write("pod/server/memory.max", "1073741824");
  CHECK(cgroup_memory_limit("0::/pod/server\n", two.root) == 1073741824u);
  two.write("pod/server/memory.max", "4294967296");
  CHECK(cgroup_memory_limit("0::/pod/server\n", two.root) == 2147483648u);
  CHECK(!cgroup_memory_limit("0::/other\n", two.root));

  const Groups one;
  one.write("memory/memory.limit_in_bytes", "9223372036854771712");
  one.write("memory/docker/abc/memory.limit_in_bytes", "536870912");
  CHECK(cgroup_memory_limit("11:cpu,cpuacct:/docker/abc\n4:memory:/docker/abc\n0::/x\n", one.root) ==
        536870912u);
}

TEST_CASE("in a container whose control group is out of sight the root's limit counts") {
  const Groups own;
  own.write("memory.max", "2147483648");
  for (const char* groups : {"0::/\n", "0::/../../pod\n", "0::/kubepods/pod7\n"})
    CHECK(cgroup_memory_limit(groups, own.root) == 2147483648u);
}

TEST_CASE("a size of memory is a number of bytes, or of KiB, MiB or GiB") {
  CHECK(memory_size("1000") == 1000u);
  CHECK(memory_size("2G") == std::uint64_t{2} << 30);
  CHECK(memory_size("1.5GiB") == std::uint64_t{3} << 29);
  CHECK(memory_size("512M") == 512u << 20);
  for (const char* text : {"", "G", "-1G", "2X", "2Gi", "2GB", "1e30", "nan"}) CHECK(!memory_size(text));
}
