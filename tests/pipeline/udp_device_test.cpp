#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// The device that is another program: tools/plugins/udp.

namespace sulcus::udp_device_test {
namespace {

using test::sulcus_command;

/// As tools/plugins/udp/udp_device.c says, written down once more.
struct PoseDatagram {
  char magic[4]{'S', 'U', 'L', 'P'};
  std::uint32_t version = 1;
  std::uint64_t number = 0;
  double position_m[3]{0, 0, 1.5e-3};
  double orientation[4]{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  std::uint32_t flags = 0, zero = 0;
};
struct WrenchDatagram {
  char magic[4];
  std::uint32_t version;
  std::uint64_t number, tick;
  double force_N[3], torque_Nm[3];
  std::uint32_t flags, zero;
};
static_assert(sizeof(PoseDatagram) == 80 && sizeof(WrenchDatagram) == 80);

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// A port that nobody has at the moment.
int free_port() {
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  EXPECT_EQ(bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_EQ(getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  close(probe);
  return ntohs(address.sin_port);
}

/// A device of the test's own, on a thread: sends a pose, waits for a wrench, and so on, until the
/// run is over or it has been told to end.
class Peer {
 public:
  /// `change`: what is wrong with the datagram of a number; false: it is not sent.
  using Change = std::function<bool(PoseDatagram&)>;
  Peer(int port, Change change)
      : change_(std::move(change)), thread_([this, port] { talk(port); }) {}
  ~Peer() { end(); }
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  // After end().
  std::uint64_t wrenches = 0;
  double largest_N = 0.0;
  bool over = false;
  WrenchDatagram last{};

 private:
  void talk(int port) {
    const int own = socket(AF_INET, SOCK_DGRAM, 0);
    const sockaddr_in to = loopback(port);
    connect(own, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
    const timeval wait{0, 5000};
    setsockopt(own, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
    for (std::uint64_t number = 1; !stop_ && !over;) {
      PoseDatagram pose;
      // Deeper and deeper, into the block.
      pose.position_m[2] -= 1.5e-3 * std::min(1.0, static_cast<double>(wrenches) / 200.0);
      pose.number = number;
      if (change_(pose)) send(own, &pose, sizeof(pose), 0);
      WrenchDatagram answer{};
      if (recv(own, &answer, sizeof(answer), 0) != sizeof(answer)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // nobody there
        continue;
      }
      ++number;
      ++wrenches;
      last = answer;
      largest_N =
          std::max(largest_N, std::hypot(answer.force_N[0], answer.force_N[1], answer.force_N[2]));
      over = (answer.flags & 1u) != 0;
    }
    close(own);
  }

  Change change_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class UdpDevice : public ::testing::Test {
 protected:
  test::CommandResult run(int timeout_ms) {
    const std::string scene = scratch_.write(
        "s.toml", test::block_and_burr() +
                      "[trajectory]\npoints_mm = [[0, 0, 1.5]]\nhold_s = 1\n"
                      "[coupling]\n[record]\n[device]\nplugin = 'udp'\n"
                      "settings = 'port=" +
                      std::to_string(port_) + " timeout_ms=" + std::to_string(timeout_ms) + "'\n");
    return sulcus_command("run " + scene +
                              " --pace real --duration 1 --force --plugins " SULCUS_PLUGINS " -o " +
                              scratch_.path("out"),
                          scratch_.path("err"));
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  }
  void expect_verified() {
    const auto verified = sulcus_command("replay --verify " + scratch_.path("out/recording.h5"),
                                         scratch_.path("err"));
    EXPECT_EQ(verified.status, 0) << verified.err;
  }
  const ScratchFolder scratch_;
  const int port_ = free_port();
};

TEST_F(UdpDevice, AnotherProgramIsTheDevice) {
  Peer peer(port_, [](PoseDatagram&) { return true; });
  const auto result = run(500);
  EXPECT_EQ(result.status, 0) << result.err;
  peer.end();
  EXPECT_TRUE(peer.over);
  EXPECT_EQ(peer.last.force_N[2], 0.0);
  EXPECT_GT(peer.largest_N, 0.5);
  const auto ticks = RecordingReader(scratch_.path("out/recording.h5")).ticks();
  EXPECT_GT(std::ranges::count_if(ticks, [](const TickRecord& row) { return row.contacts > 0; }),
            300);
  expect_verified();
}

TEST_F(UdpDevice, TheClientInPythonClosesTheLoop) {
  if (std::system("python3 -c 'import socket' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  test::CommandResult client;
  std::thread beside([&] {
    client = test::program_command("python3 " SULCUS_SOURCE_DIR "/tools/plugins/udp/client.py",
                                   std::to_string(port_), scratch_.path("client"));
  });
  const std::string settings =
      " --set device.settings='port=" + std::to_string(port_) + " timeout_ms=500'";
  const auto result =
      sulcus_command("run " SULCUS_SOURCE_DIR "/scenes/udp_hand.toml" + settings +
                         " --pace real --plugins " SULCUS_PLUGINS " -o " + scratch_.path("out"),
                     scratch_.path("err"));
  beside.join();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(client.status, 0) << client.err;
  int ticks = 0;
  double largest_N = 0.0;
  EXPECT_EQ(std::sscanf(client.out.c_str(), "%d ticks, at most %lf N", &ticks, &largest_N), 2)
      << client.out;
  EXPECT_GT(ticks, 1000);
  EXPECT_GT(largest_N, 0.3);  // its spring is 1 mm in: 0.5 N against the coupling
  EXPECT_LT(largest_N, 2.0);
  expect_verified();
}

TEST_F(UdpDevice, PosesThatStopAreASilence) {
  Peer peer(port_, [](const PoseDatagram& p) { return p.number <= 150; });
  const auto result = run(20);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("gave no pose in"), std::string::npos) << result.err;
  EXPECT_GE(summary()["device"]["silent_ticks"], 100);
  const auto ticks = RecordingReader(scratch_.path("out/recording.h5")).ticks();
  EXPECT_GT(summary()["force_N"]["max"].get<double>(), 0.3);
  EXPECT_EQ(ticks.back().force_N[2], 0.0);
  expect_verified();
}

TEST_F(UdpDevice, APoseThatIsNoneAndAGoodbyeEndTheRun) {
  struct Case {
    const char* name;
    Peer::Change change;
    int status;
    std::string said;
  };
  const Case cases[] = {
      {"not a number",
       [](PoseDatagram& p) {
         if (p.number > 150) p.position_m[0] = std::numeric_limits<double>::quiet_NaN();
         return true;
       },
       1, "gave what is no pose"},
      {"goodbye",
       [](PoseDatagram& p) {
         p.flags = p.number > 150 ? 1 : 0;
         return true;
       },
       0, ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    Peer peer(port_, c.change);
    const auto result = run(500);
    EXPECT_EQ(result.status, c.status) << result.err;
    EXPECT_NE(result.err.find(c.said), std::string::npos) << result.err;
    peer.end();
    EXPECT_EQ(peer.last.force_N[2], 0.0);
    expect_verified();
  }
}

TEST_F(UdpDevice, WhatIsNoDatagramOfItsIsLeftOut) {
  Peer peer(port_, [](PoseDatagram& p) {
    p.version = 3;
    return true;
  });
  Peer other(port_, [](PoseDatagram& p) {
    p.magic[0] = 'X';
    return true;
  });
  const auto result = run(20);
  EXPECT_EQ(result.status, 0) << result.err;
  peer.end();
  EXPECT_EQ(peer.wrenches, 0u);
  for (const char* said : {"no pose ever came", "of another version than 1 and 2"}) {
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
  }
  EXPECT_EQ(summary()["device"]["silent_ticks"], summary()["ticks"]);
}

TEST_F(UdpDevice, APortThatIsTakenIsRefused) {
  const int taken = socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in address = loopback(port_);
  ASSERT_EQ(bind(taken, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  const auto result = run(20);
  close(taken);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("Address already in use"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace sulcus::udp_device_test
