// Shader errors name the file and line of the source, also inside an include; uniforms are found by name.
#include <filesystem>
#include <fstream>
#include <string>
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

TEST_CASE("a program with too many storage blocks is an error that says how many it has and may have") {
  const auto context = test::context();
  const fs::path root = fs::temp_directory_path() / "clothlab-blocks-test";
  fs::create_directories(root / "shaders");
  constexpr int many = 100;
  for (const int blocks : {2, many}) {
    std::ofstream file(root / "shaders" / (std::to_string(blocks) + ".comp"));
    file << "layout(local_size_x = 1) in;\n";
    for (int i = 0; i < blocks; ++i) {
      const int slot = i % 8;
      file << "layout(std430, binding = " << slot << ") buffer B" << i << " { float b" << i << "; };\n";
    }
    file << "void main() {\n";
    for (int i = 0; i < blocks; ++i) file << "b" << i << " += 1.0;\n";
    file << "}\n";
  }
  setenv("CLOTHLAB_DATA", root.c_str(), 1);
  CHECK(gl::Program::load({"2.comp"}));
  const Result<gl::Program> refused = gl::Program::load({std::to_string(many) + ".comp"});
  setenv("CLOTHLAB_STORAGE_BLOCKS", "1", 1);
  const Result<gl::Program> limited = gl::Program::load({"2.comp"});
  unsetenv("CLOTHLAB_STORAGE_BLOCKS");
  unsetenv("CLOTHLAB_DATA");
  fs::remove_all(root);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().what,
             ContainsSubstring("at most 100 storage blocks, of which this device allows"));
  REQUIRE_FALSE(limited);
  CHECK(limited.error().where == "shaders/2.comp");
  CHECK(limited.error().what == "has 2 storage blocks, and a program may have 1 here");
}
