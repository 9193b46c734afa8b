#pragma once

#include <string>
#include <unordered_map>

#include <Eigen/Core>

namespace sulcus {

/// A linked shader program of the current OpenGL context, and its uniforms by name.
class GlProgram {
 public:
  /// Throws std::runtime_error with the compiler's message.
  GlProgram(const std::string& name, const char* vertex_source, const char* fragment_source);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const;
  // Of the program in use. A name that the compiler dropped is ignored.
  void set(const char* name, float value);
  void set(const char* name, int value);
  void set(const char* name, const Eigen::Vector3f& value);
  void set(const char* name, const Eigen::Vector4f& value);
  void set(const char* name, const Eigen::Matrix4f& value);

 private:
  int location(const char* name);

  unsigned program_ = 0;
  std::unordered_map<std::string, int> locations_;
};

}  // namespace sulcus
