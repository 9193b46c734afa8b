#include "app/stream/stream_server.hpp"

#include <thread>
#include <utility>

#include <poll.h>

#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

/// At once; who comes when so many are there is let in when one has gone.
constexpr std::size_t kMostClients = 8;
/// A client that takes nothing for so long is not waited for at the end.
constexpr double kEndSilence_s = 0.25;

}  // namespace

void StreamServer::serve(std::chrono::milliseconds longest, const StreamBytes& greeting) {
  std::vector<pollfd> watched;
  watched.reserve(clients_.size() + 1);
  for (const auto& client : clients_) {
    const bool sends = client->has_to_send();
    watched.push_back(
        {client->descriptor(), static_cast<short>(sends ? POLLIN | POLLOUT : POLLIN), 0});
  }
  if (clients_.size() < kMostClients) watched.push_back({port_.descriptor(), POLLIN, 0});
  if (poll(watched.data(), watched.size(), static_cast<int>(longest.count())) < 0) return;
  const bool knocked = watched.size() > clients_.size() && watched.back().revents != 0;

  std::vector<StreamRequest> requests;
  for (std::size_t i = clients_.size(); i-- > 0;) {
    StreamClient& client = *clients_[i];
    bool stays = true;
    if (watched[i].revents & (POLLIN | POLLHUP | POLLERR)) stays = client.receive(requests);
    for (StreamRequest& request : requests) {
      requests_.push_back({client.number(), std::move(request)});
    }
    requests.clear();
    if (!stays || !client.send()) let_go(i);
  }
  // Where the system has no descriptor left for who knocks, that one keeps knocking.
  if (knocked && !let_in(greeting)) std::this_thread::sleep_for(longest);
}

/// Whether anybody has come.
bool StreamServer::let_in(const StreamBytes& greeting) {
  const std::uint64_t before = came_;
  while (clients_.size() < kMostClients) {
    Socket socket = port_.accept();
    if (!socket) break;
    clients_.push_back(std::make_unique<StreamClient>(std::move(socket), came_++, most_samples_));
    if (greeting) clients_.back()->push(greeting, StreamKind::kNews);
  }
  return came_ > before;
}

void StreamServer::let_go(std::size_t index) {
  samples_of_gone_ += clients_[index]->samples();
  dropped_of_gone_ += clients_[index]->unsent();
  clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(index));
}

void StreamServer::send_to_all(const StreamBytes& bytes, StreamKind kind) {
  for (const auto& client : clients_) client->push(bytes, kind);
}

void StreamServer::send_to(std::uint64_t client, const StreamBytes& bytes, StreamKind kind) {
  for (const auto& each : clients_) {
    if (each->number() == client) each->push(bytes, kind);
  }
}

std::size_t StreamServer::answers_waiting(std::uint64_t client) const {
  for (const auto& each : clients_) {
    if (each->number() == client) return each->answers_waiting();
  }
  return 0;
}

void StreamServer::finish(std::chrono::milliseconds longest) {
  const std::uint64_t begin = steady_ns();
  const double longest_s = std::chrono::duration<double>(longest).count();
  for (;;) {
    std::vector<pollfd> watched;
    for (std::size_t i = clients_.size(); i-- > 0;) {
      StreamClient& client = *clients_[i];
      if (!client.send() || !client.has_to_send() || client.silence_s() > kEndSilence_s) {
        // What it has sent and nobody has read would take what is still on its way to it along.
        std::vector<StreamRequest> unanswered;
        (void)client.receive(unanswered);
        let_go(i);
      } else {
        watched.push_back({client.descriptor(), POLLOUT, 0});
      }
    }
    if (watched.empty() || seconds_since(begin) > longest_s) break;
    constexpr int kLongestSleep_ms = 10;
    (void)poll(watched.data(), watched.size(), kLongestSleep_ms);
  }
  while (!clients_.empty()) let_go(clients_.size() - 1);
}

std::uint64_t StreamServer::samples() const {
  std::uint64_t samples = samples_of_gone_;
  for (const auto& client : clients_) samples += client->samples();
  return samples;
}

std::uint64_t StreamServer::dropped() const {
  std::uint64_t dropped = dropped_of_gone_;
  for (const auto& client : clients_) dropped += client->unsent();
  return dropped;
}

}  // namespace sulcus
