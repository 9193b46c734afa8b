#pragma once

#include <string>
#include <utility>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// A socket, closed with its owner.
class Socket {
 public:
  explicit Socket(int descriptor = -1) : descriptor_(descriptor) {}
  ~Socket();
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  explicit operator bool() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// The TCP port at which clients of a run are waited for, from before its first tick on. (The
/// library's own server socket listens on every address of the machine.)
class StreamPort {
 public:
  /// InputError of the file of the scene, whose [stream] names it, where the address is none of
  /// this machine's or the port is taken.
  explicit StreamPort(const Scene& scene);

  /// Who has connected, never waited for; none: nobody.
  Socket accept() const;
  int descriptor() const { return listening_.descriptor(); }

 private:
  Socket listening_;
};

}  // namespace sulcus
