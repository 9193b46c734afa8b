// A client at the other end of a pair of sockets: what it sends, and what it does not take.
#include "app/stream/stream_client.hpp"

#include <cstring>
#include <optional>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace sulcus::stream_client_test {
namespace {

/// A header as the protocol has it, written down once more: big-endian, 58 bytes.
std::string header(std::uint16_t version, std::string type, std::string device,
                   std::uint64_t body_size) {
  const auto big_endian = [](std::uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes; i-- > 0;) text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
  };
  type.resize(12);
  device.resize(20);
  return big_endian(version, 2) + type + device + big_endian(0, 8) + big_endian(body_size, 8) +
         big_endian(0, 8);
}

class StreamClientTest : public ::testing::Test {
 protected:
  StreamClientTest() {
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    other_ = Socket(ends[1]);
    client_.emplace(Socket(ends[0]), 0, 3);
  }
  void say(const std::string& bytes) const {
    ASSERT_EQ(write(other_.descriptor(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  /// What has come at the other end.
  std::string hear() const {
    std::string all(1 << 22, '\0');
    const ssize_t got = read(other_.descriptor(), all.data(), all.size());
    all.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return all;
  }
  static StreamBytes bytes_of(const std::string& text) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return std::make_shared<const std::vector<std::byte>>(bytes);
  }
  Socket other_;
  std::optional<StreamClient> client_;
  std::vector<StreamRequest> requests_;
};

TEST_F(StreamClientTest, RequestsAreReadHoweverTheyAreCut) {
  const std::string both = header(1, "GET_POLYDATA", "Tooth", 0) + header(2, "TRANSFORM", "x", 48) +
                           std::string(48, 'G') + header(3, "GET_IMAGE", "", 4) + "abcd";
  for (const std::size_t part : {both.size(), std::size_t{1}, std::size_t{57}, std::size_t{59}}) {
    requests_.clear();
    for (std::size_t at = 0; at < both.size(); at += part) {
      say(both.substr(at, part));
      ASSERT_TRUE(client_->receive(requests_));
    }
    ASSERT_EQ(requests_.size(), 2u) << part;
    EXPECT_EQ(requests_[0].type, "POLYDATA");
    EXPECT_EQ(requests_[0].device, "Tooth");
    EXPECT_EQ(requests_[1].type, "IMAGE");
    EXPECT_EQ(requests_[1].device, "");
  }
}

TEST_F(StreamClientTest, WhatIsNoMessageEndsIt) {
  for (const std::string& wrong :
       {header(0, "GET_IMAGE", "", 0), header(0x4854, "GET_IMAGE", "", 0),
        header(1, "IMAGE", "", (std::uint64_t{1} << 31) + 1),
        header(1, "IMAGE", "", ~std::uint64_t{0}), std::string(58, '\xff')}) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    other_ = Socket(ends[1]);
    StreamClient client(Socket{ends[0]}, 0, 3);
    say(wrong);
    EXPECT_FALSE(client.receive(requests_));
    EXPECT_TRUE(requests_.empty());
  }
}

// A body that is said to be large is passed over as it comes, and no memory is taken for it.
TEST_F(StreamClientTest, ALargeBodyIsPassedOver) {
  say(header(1, "IMAGE", "", 100'000));
  const std::string part(10'000, 'x');
  for (int i = 0; i < 10; ++i) {
    say(part);
    ASSERT_TRUE(client_->receive(requests_));
  }
  EXPECT_TRUE(requests_.empty());
  say(header(1, "GET_STATUS", "", 0));
  ASSERT_TRUE(client_->receive(requests_));
  EXPECT_EQ(requests_.size(), 1u);
}

TEST_F(StreamClientTest, RandomBytesDoNoHarm) {
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    other_ = Socket(ends[1]);
    StreamClient client(Socket{ends[0]}, 0, 3);
    // Random from a place on, so that headers are gone into at all depths.
    std::string bytes = header(1, "GET_POLYDATA", "Tooth", 0) + header(1, "IMAGE", "", 10);
    bytes.resize(300);
    for (std::size_t i = random() % 130; i < bytes.size(); ++i) {
      bytes[i] = static_cast<char>(random());
    }
    say(bytes);
    (void)client.receive(requests_);
    for (const StreamRequest& request : requests_) {
      EXPECT_LE(request.type.size(), 8u);
      EXPECT_LE(request.device.size(), 20u);
    }
    requests_.clear();
  }
}

TEST_F(StreamClientTest, OfSamplesTheOldestAreDroppedAndOfAnswersNone) {
  for (int i = 0; i < 10; ++i) {
    client_->push(bytes_of(std::to_string(i)), StreamKind::kSample);
    if (i == 2) client_->push(bytes_of("answer "), StreamKind::kAnswer);
  }
  EXPECT_EQ(client_->samples(), 10u);
  EXPECT_EQ(client_->unsent(), 10u);
  ASSERT_TRUE(client_->send());
  EXPECT_EQ(hear(), "answer 789");
  EXPECT_EQ(client_->unsent(), 7u);
  EXPECT_FALSE(client_->has_to_send());
}

TEST_F(StreamClientTest, WhatIsSentInPartIsSentWhole) {
  const std::string large(1 << 20, 'a');  // more than the system takes at once
  client_->push(bytes_of(large), StreamKind::kSample);
  ASSERT_TRUE(client_->send());
  EXPECT_TRUE(client_->has_to_send());
  for (int i = 0; i < 10; ++i) client_->push(bytes_of("b"), StreamKind::kSample);
  std::string all;
  for (int i = 0; i < 1000 && client_->has_to_send(); ++i) {
    all += hear();
    ASSERT_TRUE(client_->send());
  }
  all += hear();
  // Of the eleven three may wait: the one that had begun, and the last two.
  EXPECT_EQ(all, large + "bb");
  EXPECT_EQ(client_->unsent(), 8u);
}

// Without the signal that would end the program.
TEST_F(StreamClientTest, WhoHasGoneIsSeenToHaveGone) {
  other_ = Socket();
  client_->push(bytes_of("a"), StreamKind::kSample);
  EXPECT_FALSE(client_->send());
  EXPECT_FALSE(client_->receive(requests_));
}

}  // namespace
}  // namespace sulcus::stream_client_test
