// Shader errors name the file and line of the source, also inside an include; uniforms are found by name.
#include <filesystem>
#include <fstream>
#include <utility>

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
  write("warned.comp",
        "layout(local_size_x = 1) in;\nfloat unset;\nvoid main() {\n  unset += unset;\n  "
        "undefined_call();\n}\n");
  write("lost.comp", "layout(local_size_x = 1) in;\n#include \"nowhere.glsl\"\n");
  setenv("CLOTHLAB_DATA", root.c_str(), 1);

  const auto where = [](const char* path) {
    const Result<gl::Program> program = gl::Program::load({path});
    REQUIRE_FALSE(program);
    return program.error().where;
  };
  CHECK(where("outer.comp") == "shaders/part/bad.glsl:2");
  CHECK(where("inner.comp") == "shaders/inner.comp:5");
  CHECK(where("warned.comp") == "shaders/warned.comp:5");
  CHECK(where("lost.comp").find("shaders/lost.comp:2") == 0);
  unsetenv("CLOTHLAB_DATA");
  fs::remove_all(root);
}

TEST_CASE("a uniform is set by its name, an array by its name alone, and one that is not used is no error") {
  const auto context = test::context();
  const fs::path root = fs::temp_directory_path() / "clothlab-uniform-test";
  fs::create_directories(root / "shaders");
  std::ofstream(root / "shaders/sum.comp")
      << "layout(local_size_x = 1) in;\nuniform int whole, idle;\nuniform float part;\n"
         "uniform float list[2];\nbuffer Out { float sum; };\n"
         "void main() { sum = float(whole) + part + list[0] + list[1]; }\n";
  setenv("CLOTHLAB_DATA", root.c_str(), 1);
  Result<gl::Program> loaded = gl::Program::load({"sum.comp"});
  unsetenv("CLOTHLAB_DATA");
  fs::remove_all(root);
  REQUIRE(loaded);
  const gl::Program program = std::move(*loaded);

  program.set("whole", 3);
  program.set("part", 0.5f);
  program.set("idle", 7);
  program.set("nowhere", 7.0f);
  glProgramUniform1f(program.id(), program.location("list"), 0.25f);
  CHECK(program.location("idle") == -1);
  CHECK(glGetError() == GL_NO_ERROR);
  const auto value = [&](const char* name) {
    GLfloat is = 0;
    glGetUniformfv(program.id(), glGetUniformLocation(program.id(), name), &is);
    return is;
  };
  CHECK(value("whole") == 3.0f);
  CHECK(value("part") == 0.5f);
  CHECK(value("list[0]") == 0.25f);
}
