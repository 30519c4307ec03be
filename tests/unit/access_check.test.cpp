// What the check of barriers takes for a fault, command by command.
#include <string>
#include <vector>

#include "server/gl/access_check.h"
#include "tests/catch.h"

using namespace clothlab;
using gl::Access;

namespace {

/// A check, and the faults that it has told.
struct Checked {
  std::vector<std::string> faults;
  gl::AccessCheck check{[this](const std::string& fault) { faults.push_back(fault); }};

  void command(const std::vector<gl::Use>& uses) { check.command(uses); }
};

}  // namespace

TEST_CASE("what a shader wrote needs the barrier of whoever reads it, and no other") {
  struct Reader {
    Access access;
    GLbitfield needs;
  };
  for (const Reader& reader : {Reader{Access::storage_read, GL_SHADER_STORAGE_BARRIER_BIT},
                               {Access::storage_write, GL_SHADER_STORAGE_BARRIER_BIT},
                               {Access::texture, GL_TEXTURE_FETCH_BARRIER_BIT},
                               {Access::uniform, GL_UNIFORM_BARRIER_BIT},
                               {Access::command, GL_COMMAND_BARRIER_BIT},
                               {Access::attribute, GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT},
                               {Access::element, GL_ELEMENT_ARRAY_BARRIER_BIT},
                               {Access::read_back, GL_BUFFER_UPDATE_BARRIER_BIT},
                               {Access::update, GL_BUFFER_UPDATE_BARRIER_BIT},
                               {Access::mapped, GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT}}) {
    INFO("access " << static_cast<int>(reader.access));
    for (const GLbitfield barrier : {0u, ~reader.needs, reader.needs}) {
      Checked checked;
      checked.command({{7, Access::storage_write, "one"}});
      if (barrier != 0) checked.check.barrier(barrier);
      checked.command({{7, reader.access, "other"}});
      CHECK(checked.faults.size() == (barrier == reader.needs ? 0 : 1));
    }
  }
}

TEST_CASE("a fault names who wrote, who comes after, and the barrier") {
  Checked checked;
  checked.command({{7, Access::storage_write, "a.comp (storage block A)"}});
  checked.command({{7, Access::texture, "b.comp (buffer texture b)"}});
  REQUIRE(checked.faults.size() == 1);
  CHECK(checked.faults[0] ==
        "a.comp (storage block A) writes what b.comp (buffer texture b) reads, without "
        "GL_TEXTURE_FETCH_BARRIER_BIT between them");
}

TEST_CASE("a write waits for the reads before it, but two reads for nothing, nor one command for itself") {
  Checked checked;
  checked.command({{7, Access::texture, "one"}, {8, Access::storage_write, "one"}});
  checked.command({{7, Access::texture, "two"}, {7, Access::storage_read, "two"}});
  CHECK(checked.faults.empty());
  checked.command({{7, Access::storage_write, "three"}, {7, Access::storage_read, "three"}});
  REQUIRE(checked.faults.size() == 1);
  CHECK(checked.faults[0].find("two reads what three writes") == 0);
}

TEST_CASE("an upload or copy waits for what shaders wrote, and is waited for by itself") {
  Checked checked;
  checked.command({{7, Access::texture, "shader"}});
  checked.command({{7, Access::update, "upload"}});
  checked.command({{7, Access::storage_read, "shader"}});
  checked.command({{7, Access::read_back, "copy"}});
  CHECK(checked.faults.empty());
}

TEST_CASE("a barrier before the write is none, and other buffers are others") {
  Checked checked;
  checked.check.barrier(GL_ALL_BARRIER_BITS);
  checked.command({{7, Access::storage_write, "one"}});
  checked.command({{8, Access::storage_read, "other"}});
  CHECK(checked.faults.empty());
  checked.command({{7, Access::storage_read, "other"}});
  CHECK(checked.faults.size() == 1);
  checked.check.forget(7);
  checked.command({{7, Access::storage_read, "of the same name"}});
  CHECK(checked.faults.size() == 1);
}
