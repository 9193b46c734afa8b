#include "app/stream/stream_port.hpp"

#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "engine/core/error.hpp"

namespace sulcus {

namespace {

/// What a client may leave unread in the system on our side. Older samples are dropped sooner, and
/// what comes is younger.
constexpr int kSendBuffer = 64 << 10;

void set_option(int descriptor, int level, int name, int value) {
  // Refused, it is slower or takes more memory, and works.
  (void)setsockopt(descriptor, level, name, &value, sizeof(value));
}

}  // namespace

Socket::~Socket() {
  if (descriptor_ >= 0) close(descriptor_);
}

StreamPort::StreamPort(const Scene& scene) {
  const StreamSettings& settings = *scene.stream;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(settings.port));
  if (inet_pton(AF_INET, settings.address.c_str(), &address.sin_addr) != 1) {
    throw InputError(scene.file, "stream.address", "'" + settings.address + "'",
                     "an IPv4 address of this machine, such as \"127.0.0.1\"");
  }
  listening_ = Socket(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int descriptor = listening_.descriptor();
  // Else a run right after another would find the port taken for a minute.
  set_option(descriptor, SOL_SOCKET, SO_REUSEADDR, 1);
  constexpr int kWaiting = 8;
  if (!listening_ ||
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      listen(descriptor, kWaiting) != 0) {
    const int error = errno;
    throw InputError(
        scene.file, error == EADDRNOTAVAIL ? "stream.address" : "stream.port",
        settings.address + ":" + std::to_string(settings.port) + ": " + std::strerror(error),
        error == EADDRNOTAVAIL ? "an IPv4 address of this machine" : "a port that is free");
  }
}

Socket StreamPort::accept() const {
  Socket client(accept4(descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (client) {
    set_option(client.descriptor(), SOL_SOCKET, SO_SNDBUF, kSendBuffer);
    set_option(client.descriptor(), IPPROTO_TCP, TCP_NODELAY, 1);
  }
  return client;
}

}  // namespace sulcus
