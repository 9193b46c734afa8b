#include "engine/cache/load_cache.hpp"

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::load_cache_test {
namespace {

namespace fs = std::filesystem;

Hash128 key_of(const std::string& text) {
  return LoadCache::key_of(CacheKind::kField).add(text).result();
}

void write(LoadCache& cache, const Hash128& key, const std::string& payload) {
  cache.write(CacheKind::kField, key, {std::as_bytes(std::span(payload))});
}

/// The payload of an entry; empty where it is refused.
std::optional<std::string> read(LoadCache& cache, const Hash128& key,
                                CacheKind kind = CacheKind::kField) {
  std::string payload;
  const bool read = cache.read(kind, key, [&](std::uint64_t bytes) {
    payload.resize(bytes);
    return std::as_writable_bytes(std::span(payload));
  });
  return read ? std::optional(payload) : std::nullopt;
}

int files_in(const std::string& folder) {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++count;
  return count;
}

/// Sets a variable of the environment, and puts it back.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value ? std::optional<std::string>(value) : std::nullopt);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value) {
      setenv(name_, value->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }
  const char* name_;
  std::optional<std::string> before_;
};

TEST(LoadCache, GivesBackWhatItWasGiven) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path("made/here"));
  EXPECT_FALSE(read(cache, key_of("a"))) << "nothing yet";
  const std::string one = "one", two(100'000, 'x');
  cache.write(CacheKind::kField, key_of("a"),
              {std::as_bytes(std::span(one)), {}, std::as_bytes(std::span(two))});
  write(cache, key_of("b"), "");
  EXPECT_EQ(read(cache, key_of("a")), one + two);
  EXPECT_EQ(read(cache, key_of("b")), "");
  EXPECT_EQ(cache.hits(), 2);
  EXPECT_EQ(files_in(scratch.path("made/here")), 2) << "no temporary file stays";
  EXPECT_EQ(cache.note(), "");
  LoadCache later(scratch.path("made/here"));
  EXPECT_EQ(read(later, key_of("a")), one + two);
}

TEST(LoadCache, RefusesEveryWrongEntryAndTakesTheNextOne) {
  const ScratchFolder scratch;
  const Hash128 key = key_of("a");
  const std::string good = [&] {
    LoadCache cache(scratch.path("c"));
    write(cache, key, "a payload of some length");
    return test::read_file(cache.entry(key).string());
  }();
  std::vector<std::pair<std::string, std::string>> wrong;
  // Every byte of header and payload is looked at.
  for (std::size_t byte = 0; byte < good.size(); ++byte) {
    std::string damaged = good;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 0x10);
    wrong.emplace_back("byte " + std::to_string(byte), damaged);
  }
  for (std::size_t length : {std::size_t{0}, std::size_t{63}, std::size_t{64}, good.size() - 1}) {
    wrong.emplace_back("cut to " + std::to_string(length), good.substr(0, length));
  }
  wrong.emplace_back("longer", good + "x");
  wrong.emplace_back("foreign", std::string(500, 'z'));
  std::string huge = good;  // a size that no memory holds
  for (std::size_t byte = 32; byte < 40; ++byte) huge[byte] = '\x7f';
  wrong.emplace_back("huge", huge);

  for (const auto& [what, bytes] : wrong) {
    LoadCache cache(scratch.path("c"));
    std::ofstream(cache.entry(key), std::ios::binary) << bytes;
    EXPECT_FALSE(read(cache, key)) << what;
    EXPECT_EQ(cache.hits(), 0) << what;
    EXPECT_NE(cache.note().find("load cache: "), std::string::npos) << what;
    write(cache, key, "made again");
    EXPECT_EQ(read(cache, key), "made again") << what;
  }
  LoadCache cache(scratch.path("c"));
  EXPECT_FALSE(read(cache, key, CacheKind::kModel)) << "another kind";
  fs::rename(cache.entry(key), cache.entry(key_of("b")));
  EXPECT_FALSE(read(cache, key_of("b"))) << "another entry under this name";
}

TEST(LoadCache, WhatIsNoFileIsNoEntry) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  fs::create_directory(cache.entry(key_of("folder")));
  EXPECT_FALSE(read(cache, key_of("folder")));
  ASSERT_EQ(mkfifo(cache.entry(key_of("pipe")).c_str(), 0600), 0);
  EXPECT_FALSE(read(cache, key_of("pipe"))) << "without waiting for a writer";
}

TEST(LoadCache, TheLeastRecentlyUsedGoFirst) {
  const ScratchFolder scratch;
  const std::string payload(1000, 'p');
  LoadCache cache(scratch.path(""), 3500);
  const auto now = fs::file_time_type::clock::now();
  int hours = 10;
  for (const char* name : {"a", "b", "c"}) {
    write(cache, key_of(name), payload);
    fs::last_write_time(cache.entry(key_of(name)), now - std::chrono::hours(hours--));
  }
  const std::string foreign = scratch.write("not_ours.sulcus", std::string(9000, 'f'));
  EXPECT_TRUE(read(cache, key_of("a"))) << "now the last used";
  write(cache, key_of("d"), payload);
  EXPECT_TRUE(fs::exists(cache.entry(key_of("a"))));
  EXPECT_FALSE(fs::exists(cache.entry(key_of("b"))));
  EXPECT_TRUE(fs::exists(cache.entry(key_of("c"))));
  EXPECT_TRUE(fs::exists(cache.entry(key_of("d"))));

  write(cache, key_of("large"), std::string(4000, 'l'));
  EXPECT_FALSE(fs::exists(cache.entry(key_of("large")))) << "more than all may take";
  EXPECT_TRUE(fs::exists(cache.entry(key_of("c"))));
  EXPECT_TRUE(fs::exists(foreign)) << "not ours to remove";
}

TEST(LoadCache, WhatAKilledRunLeftIsRemovedInTime) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  const auto left = [&](const char* key, int hours) {
    const std::string name = cache.entry(key_of(key)).filename().string() + ".4711.tmp";
    const std::string path = scratch.write(name, "half");
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    return path;
  };
  const std::string old = left("a", 2), young = left("b", 0);
  write(cache, key_of("c"), "c");
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(young)) << "somebody may be writing it";
}

TEST(LoadCache, AFolderThatCannotBeWrittenKeepsNothing) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.write("file", "in the way") + "/cache");
  write(cache, key_of("a"), "a");
  EXPECT_FALSE(read(cache, key_of("a")));
  EXPECT_NE(cache.note().find("could not be written"), std::string::npos);
  LoadCache nothing;
  write(nothing, key_of("a"), "a");
  EXPECT_FALSE(read(nothing, key_of("a")));
  EXPECT_EQ(nothing.note(), "");
}

TEST(LoadCache, TheEnvironmentSaysWhere) {
  const ScratchFolder scratch;
  const std::string own = scratch.path("own"), xdg = scratch.path("xdg"), home = scratch.path("h");
  const auto folder = [](const char* cache, const char* xdg_home, const char* home_folder) {
    const Variable a("SULCUS_CACHE", cache), b("XDG_CACHE_HOME", xdg_home), c("HOME", home_folder);
    const LoadCache of_user = LoadCache::of_user();
    return of_user.keeps() ? of_user.entry({}).parent_path().string() : "none";
  };
  EXPECT_EQ(folder(own.c_str(), xdg.c_str(), home.c_str()), own);
  EXPECT_EQ(folder("", xdg.c_str(), home.c_str()), "none");
  EXPECT_EQ(folder("off", xdg.c_str(), home.c_str()), "none");
  EXPECT_EQ(folder(nullptr, xdg.c_str(), home.c_str()), xdg + "/sulcus");
  EXPECT_EQ(folder(nullptr, nullptr, home.c_str()), home + "/.cache/sulcus");
  EXPECT_EQ(folder(nullptr, "", home.c_str()), home + "/.cache/sulcus");
  EXPECT_EQ(folder(nullptr, "relative", nullptr), "none");
}

TEST(Hash128Stream, TellsSequencesApart) {
  const auto of = [](auto... values) {
    Hash128Stream stream;
    (stream.add(values), ...);
    return stream.result();
  };
  using Text = std::string_view;
  EXPECT_EQ(of(Text("ab"), 1.5), of(Text("ab"), 1.5));
  EXPECT_NE(of(Text("ab"), Text("c")), of(Text("a"), Text("bc")));
  EXPECT_NE(of(std::optional<double>()), of(std::optional<double>(0.0)));
  EXPECT_NE(of(1, 2), of(2, 1));
  EXPECT_EQ(hex(Hash128{0x1, 0xa}), "000000000000000a0000000000000001");
}

}  // namespace
}  // namespace sulcus::load_cache_test
