#include "app/stream/stream_client.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include <igtl_header.h>
#include <sys/socket.h>

#include "engine/core/realtime.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kMostNews = 64;
/// What other programs send to all who are connected is passed over; more than this is no message.
constexpr std::uint64_t kLargestBody = std::uint64_t{1} << 31;
constexpr std::uint16_t kNewestVersion = 4;
/// Taken of a client at once, so that one that sends without end does not keep the others waiting.
constexpr int kMostReads = 16;

/// Whether a call on a socket that does not wait has to be made again later.
bool is_for_later() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/// The text in a field of a header, which a null ends before its end.
template <std::size_t kSize>
std::string text_of(const char (&field)[kSize]) {
  return std::string(field, strnlen(field, kSize));
}

}  // namespace

StreamClient::StreamClient(Socket socket, std::uint64_t number, std::size_t most_samples)
    : socket_(std::move(socket)),
      number_(number),
      most_samples_(most_samples),
      taken_ns_(steady_ns()) {
  static_assert(kHeaderBytes == IGTL_HEADER_SIZE);
}

void StreamClient::push(StreamBytes bytes, StreamKind kind) {
  if (queue_.empty()) taken_ns_ = steady_ns();
  queue_.push_back({std::move(bytes), kind});
  if (kind == StreamKind::kSample) {
    ++samples_;
    if (++waiting_samples_ > most_samples_) drop_oldest(kind);
  } else if (kind == StreamKind::kNews) {
    if (++waiting_news_ > kMostNews) drop_oldest(kind);
  } else {
    ++waiting_answers_;
  }
}

/// What has been sent in part has to be sent whole.
void StreamClient::drop_oldest(StreamKind kind) {
  const auto first = queue_.begin() + (sent_ > 0 ? 1 : 0);
  const auto oldest =
      std::find_if(first, queue_.end(), [&](const Entry& e) { return e.kind == kind; });
  queue_.erase(oldest);  // the one that was pushed last is there
  if (kind == StreamKind::kSample) {
    --waiting_samples_;
    ++dropped_;
  } else {
    --waiting_news_;
  }
}

bool StreamClient::send() {
  while (!queue_.empty()) {
    const std::vector<std::byte>& bytes = *queue_.front().bytes;
    // Without a signal where nobody is at the other end.
    const ssize_t sent = ::send(descriptor(), bytes.data() + sent_, bytes.size() - sent_,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) return is_for_later() && silence_s() < kLongestSilence_s;
    taken_ns_ = steady_ns();
    sent_ += static_cast<std::size_t>(sent);
    if (sent_ < bytes.size()) continue;
    if (queue_.front().kind == StreamKind::kSample) --waiting_samples_;
    if (queue_.front().kind == StreamKind::kNews) --waiting_news_;
    if (queue_.front().kind == StreamKind::kAnswer) --waiting_answers_;
    queue_.pop_front();
    sent_ = 0;
  }
  return true;
}

double StreamClient::silence_s() const { return queue_.empty() ? 0.0 : seconds_since(taken_ns_); }

bool StreamClient::receive(std::vector<StreamRequest>& requests) {
  std::array<std::byte, 4096> buffer;
  for (int reads = 0; reads < kMostReads; ++reads) {
    const ssize_t got = recv(descriptor(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (got == 0) return false;
    if (got < 0) return is_for_later();
    if (!take(std::span(buffer).first(static_cast<std::size_t>(got)), requests)) return false;
  }
  return true;
}

bool StreamClient::take(std::span<const std::byte> bytes, std::vector<StreamRequest>& requests) {
  while (!bytes.empty()) {
    if (body_left_ > 0) {
      const std::size_t passed =
          static_cast<std::size_t>(std::min<std::uint64_t>(body_left_, bytes.size()));
      body_left_ -= passed;
      bytes = bytes.subspan(passed);
      continue;
    }
    const std::size_t part = std::min(bytes.size(), kHeaderBytes - header_filled_);
    std::ranges::copy(bytes.first(part), header_.begin() + header_filled_);
    header_filled_ += part;
    bytes = bytes.subspan(part);
    if (header_filled_ == kHeaderBytes && !take_header(requests)) return false;
  }
  return true;
}

bool StreamClient::take_header(std::vector<StreamRequest>& requests) {
  igtl_header header;
  std::memcpy(&header, header_.data(), sizeof(header));
  igtl_header_convert_byte_order(&header);
  header_filled_ = 0;
  if (header.version == 0 || header.version > kNewestVersion) return false;
  if (header.body_size > kLargestBody) return false;
  body_left_ = header.body_size;
  const std::string type = text_of(header.name);
  constexpr std::string_view kGet = "GET_";
  if (type.starts_with(kGet))
    requests.push_back({type.substr(kGet.size()), text_of(header.device_name)});
  return true;
}

}  // namespace sulcus
