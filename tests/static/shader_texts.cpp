// Writes each text that the program hands to the driver as a shader, once, into a folder: those of all
// presets under the methods that suit them, of frames, fields, hands and pictures, in both ways to read
// buffers.
//   shader_texts FOLDER
// Nothing is compiled: the driver's part is played here, so that this takes the time of making the models.
// The files are named by their hash, with the ending that tells the stage.
#include <glad/gl.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

#include "server/base/hash.h"
#include "server/gl/context.h"
#include "server/selftest/checks.h"

using namespace clothlab;

namespace {

std::filesystem::path folder;
std::map<GLuint, GLenum> stage_of;  ///< by the shader's name
PFNGLCREATESHADERPROC create_shader = nullptr;

const char* ending(GLenum stage) {
  switch (stage) {
    case GL_VERTEX_SHADER:
      return ".vert";
    case GL_GEOMETRY_SHADER:
      return ".geom";
    case GL_FRAGMENT_SHADER:
      return ".frag";
    default:
      return ".comp";
  }
}

GLuint GLAD_API_PTR create(GLenum stage) {
  const GLuint shader = create_shader(stage);
  stage_of[shader] = stage;
  return shader;
}

void write(const std::string& text, GLenum stage) {
  Hash hash;
  hash.add(text);
  const std::filesystem::path path = folder / (hash.text() + ending(stage));
  if (std::filesystem::exists(path) || std::ofstream(path) << text << std::flush) return;
  std::fprintf(stderr, "%s cannot be written\n", path.c_str());
  std::exit(1);
}

/// Of what reads buffers as textures the text that reads them as storage, too: Program::load defines so in
/// the line behind the version's.
void GLAD_API_PTR take(GLuint shader, GLsizei, const GLchar* const* texts, const GLint*) {
  std::string text = texts[0];
  write(text, stage_of[shader]);
  if (text.find("READ_STORAGE") == std::string::npos) return;
  text.insert(text.find('\n') + 1, "#define READ_STORAGE\n");
  write(text, stage_of[shader]);
}

/// A driver to which every text is right, and that has made nothing of it.
void play_the_driver() {
  create_shader = glad_glCreateShader;
  glad_glCreateShader = create;
  glad_glShaderSource = take;
  glad_glCompileShader = [](GLuint) {};
  glad_glLinkProgram = [](GLuint) {};
  glad_glGetShaderiv = [](GLuint, GLenum, GLint* value) { *value = GL_TRUE; };
  glad_glGetProgramiv = [](GLuint, GLenum name, GLint* value) {
    *value = name == GL_LINK_STATUS ? GL_TRUE : 0;
  };
  glad_glGetError = []() -> GLenum { return GL_NO_ERROR; };
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: shader_texts FOLDER\n", stderr), 2;
  folder = argv[1];
  setenv("CLOTHLAB_READS", "textures", 1);
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 2;
  play_the_driver();
  selftest::Report report([](const selftest::Check& check) {
    if (!check.passed) std::fprintf(stderr, "%s\n", selftest::line(check).c_str());
  });
  for (const char* form : {"one_group", "dispatches"}) {
    setenv("CLOTHLAB_SWEEPS", form, 1);
    selftest::check_programs(report, false);
  }
  return report.failed() == 0 ? 0 : 1;
}
