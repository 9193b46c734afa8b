#include "engine/graphics/gl_program.hpp"

#include <stdexcept>

#include <epoxy/gl.h>

namespace sulcus {
namespace {

GLuint compile(const std::string& name, GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  char log[1024] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  throw std::runtime_error("the shader '" + name + "' does not compile: " + log);
}

}  // namespace

GlProgram::GlProgram(const std::string& name, const char* vertex_source,
                     const char* fragment_source) {
  const GLuint vertex = compile(name, GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(name, GL_FRAGMENT_SHADER, fragment_source);
  program_ = glCreateProgram();
  glAttachShader(program_, vertex);
  glAttachShader(program_, fragment);
  glLinkProgram(program_);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint done = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &done);
  if (done == GL_TRUE) return;
  char log[1024] = "";
  glGetProgramInfoLog(program_, sizeof log, nullptr, log);
  glDeleteProgram(program_);
  throw std::runtime_error("the shader '" + name + "' does not link: " + log);
}

GlProgram::~GlProgram() { glDeleteProgram(program_); }

void GlProgram::use() const { glUseProgram(program_); }

int GlProgram::location(const char* name) {
  const auto [entry, added] = locations_.try_emplace(name, -1);
  if (added) entry->second = glGetUniformLocation(program_, name);
  return entry->second;
}

void GlProgram::set(const char* name, float value) { glUniform1f(location(name), value); }
void GlProgram::set(const char* name, int value) { glUniform1i(location(name), value); }
void GlProgram::set(const char* name, const Eigen::Vector3f& value) {
  glUniform3fv(location(name), 1, value.data());
}
void GlProgram::set(const char* name, const Eigen::Vector4f& value) {
  glUniform4fv(location(name), 1, value.data());
}

void GlProgram::set(const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}

}  // namespace sulcus
