#include <chrono>
#include <cstdint>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

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

// The program with [stream], and a client that knows nothing of OpenIGTLink's library: the example
// in Python.

namespace sulcus::stream_test {
namespace {

using test::sulcus_command;

/// A listening socket; where no port is named, at one that was free.
class Listener {
 public:
  explicit Listener(int port = 0) : descriptor_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(listen(descriptor_, 1), 0);
    EXPECT_EQ(getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(descriptor_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  int port() const { return port_; }

 private:
  int descriptor_, port_ = 0;
};

class Stream : public ::testing::Test {
 protected:
  test::CommandResult run(const std::string& options) const {
    const std::string scene = scratch_.write(
        "s.toml",
        test::cut_scene() + "[stream]\nrate_hz = 500\nport = " + std::to_string(port_) + "\n");
    return sulcus_command("run " + scene + " --force -o " + scratch_.path("out") + " " + options,
                          scratch_.path("err"));
  }
  /// What the example prints, in a shell with `before` its name.
  test::CommandResult follow(const std::string& before) const {
    return test::program_command(
        before + " python3 " SULCUS_SOURCE_DIR "/tools/examples/follow_stream.py",
        std::to_string(port_), scratch_.path("client"));
  }
  RecordingReader recording() const { return RecordingReader(scratch_.path("out/recording.h5")); }
  nlohmann::json summary() const {
    return nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  }
  const ScratchFolder scratch_;
  const int port_ = Listener().port();
};

TEST_F(Stream, TheExampleInPythonReadsWhatIsRecorded) {
  if (std::system("python3 -c 'import socket' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  test::CommandResult client;
  std::thread beside([&] { client = follow(""); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto result = run("--pace real");
  beside.join();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(client.status, 0) << client.err;
  EXPECT_NE(result.out.find("  stream             1 clients, "), std::string::npos) << result.out;
  const std::vector<TickRecord> rows = recording().ticks();
  std::istringstream lines(client.out);
  std::size_t count = 0;
  std::uint64_t tick = 0, last = 0;
  double p[3], f[3];
  while (lines >> tick >> p[0] >> p[1] >> p[2] >> f[0] >> f[1] >> f[2]) {
    ASSERT_LT(tick, rows.size());
    if (count++ > 0) {
      EXPECT_GT(tick, last);
    }
    last = tick;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(static_cast<float>(p[axis]),
                static_cast<float>(rows[tick].tool_position_m[axis] * 1e3));
      EXPECT_EQ(f[axis], rows[tick].force_N[axis]);
    }
  }
  const nlohmann::json sent = summary()["stream"];
  EXPECT_EQ(sent["clients"], 1);
  EXPECT_EQ(count, sent["samples"].get<std::size_t>() - sent["dropped"].get<std::size_t>());
  EXPECT_GT(count, 50u);
}

TEST_F(Stream, AClientThatIsKilledLeavesARunThatVerifies) {
  if (std::system("python3 -c 'import socket' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
  std::thread beside([&] { (void)follow("timeout -s KILL 0.8"); });
  const auto result = run("--pace real --duration 2");
  beside.join();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(recording().missing(), "");
  EXPECT_EQ(recording().tick_count(), 2000u);
  // A replay streams to nobody: it asks for no port.
  const Listener taken(port_);
  const auto verified =
      sulcus_command("replay --verify " + scratch_.path("out/recording.h5"), scratch_.path("err"));
  EXPECT_EQ(verified.status, 0) << verified.err;
}

TEST_F(Stream, WithNobodyThereItIsTheSameRun) {
  EXPECT_EQ(run("").status, 0);
  const nlohmann::json with = summary();
  EXPECT_EQ(with["stream"]["samples"], 0);
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  EXPECT_EQ(
      sulcus_command("run " + scene + " --force -o " + scratch_.path("out"), scratch_.path("err"))
          .status,
      0);
  const nlohmann::json without = summary();
  EXPECT_FALSE(without.contains("stream"));
  EXPECT_EQ(with["force_hash"], without["force_hash"]);
  EXPECT_EQ(with["volume_hash"], without["volume_hash"]);
  for (const auto& part : without["parts"]) EXPECT_NE(part["name"], "stream");
}

TEST_F(Stream, WhereItCannotListenIsSaidInOneLine) {
  const Listener taken(port_);
  const auto result = run("");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("stream.port: found 127.0.0.1:" + std::to_string(port_) +
                            ": Address already in use, expected a port that is free"),
            std::string::npos)
      << result.err;
  const auto other = run("--set stream.address=192.0.2.1");
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(other.err_lines(), 1) << other.err;
  EXPECT_NE(other.err.find("stream.address: found 192.0.2.1"), std::string::npos) << other.err;
  const auto none = run("--set stream.address=localhost");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("stream.address: found 'localhost'"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace sulcus::stream_test
