// Shader errors name the file and line of the source, also inside an include.
#include <filesystem>
#include <fstream>

#include "server/gl/program.h"
#include "tests/scenes.h"

using namespace clothlab;
namespace fs = std::filesystem;

TEST_CASE("a shader error names file and line of the source file, also in an included one") {
  const auto context = test::context();
  const fs::path root = fs::temp_directory_path() / "clothlab-shader-test";
  fs::create_directories(root / "shaders/part");
  const auto write = [&](const char* name, const char* text) {
    std::ofstream(root / "shaders" / name) << text;
  };
  write("good.glsl", "float one() { return 1.0; }\n");
  write("part/bad.glsl", "float two() {\n  return missing;\n}\n");
  write("outer.comp",
        "layout(local_size_x = 1) in;\n#include \"good.glsl\"\n#include \"part/bad.glsl\"\nvoid main() {}\n");
  write("inner.comp",
        "layout(local_size_x = 1) in;\n#include \"good.glsl\"\nvoid main() {\n\n  undefined_call();\n}\n");
  write("lost.comp", "layout(local_size_x = 1) in;\n#include \"nowhere.glsl\"\n");
  setenv("CLOTHLAB_DATA", root.c_str(), 1);

  const auto where = [](const char* path) {
    const Result<gl::Program> program = gl::Program::load({path});
    REQUIRE_FALSE(program);
    return program.error().where;
  };
  CHECK(where("outer.comp") == "shaders/part/bad.glsl:2");
  CHECK(where("inner.comp") == "shaders/inner.comp:5");
  CHECK(where("lost.comp").find("shaders/lost.comp:2") == 0);
  unsetenv("CLOTHLAB_DATA");
  fs::remove_all(root);
}
