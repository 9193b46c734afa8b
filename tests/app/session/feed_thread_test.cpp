#include "app/session/feed_thread.hpp"

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

namespace sulcus::feed_thread_test {
namespace {

constexpr std::chrono::microseconds kPeriod{100};

/// Counts the edits of a feed on a thread; throws at the one after `most`.
struct Counter {
  explicit Counter(Feed& feed, int most = 1'000'000) : thread(feed) {
    thread.start(
        [this, &feed, most] {
          drain_until_ended(feed, kPeriod, [&] {
            for (Edit edit; feed.edits.try_dequeue(edit); ++count) {
              if (count == most) throw std::runtime_error("enough");
            }
          });
        },
        [this] { failed = true; });
  }
  int count = 0;
  std::atomic<bool> failed{false};
  FeedThread thread;
};

TEST(FeedThread, DrainsAllThatWasPushedBeforeTheEnd) {
  Feed feed(1000.0);
  Counter counter(feed);
  for (int i = 0; i < 5000; ++i) feed.edits.enqueue(Edit{});
  feed.ended = true;
  counter.thread.finish();
  EXPECT_EQ(counter.count, 5000);
  EXPECT_FALSE(feed.closed);
  EXPECT_FALSE(counter.failed);
}

TEST(FeedThread, ClosesTheFeedWhereItThrowsAndSaysWhyAtTheEnd) {
  Feed feed(1000.0);
  Counter counter(feed, 10);
  for (int i = 0; i < 11; ++i) feed.edits.enqueue(Edit{});
  while (!counter.failed) std::this_thread::yield();
  EXPECT_TRUE(feed.closed);
  EXPECT_THROW(counter.thread.finish(), std::runtime_error);
}

TEST(FeedThread, EndsWithItsOwner) {
  Feed feed(1000.0);
  std::make_unique<Counter>(feed).reset();
  EXPECT_TRUE(feed.ended);
}

TEST(FirstFailure, KeepsTheFirst) {
  FirstFailure failure;
  EXPECT_TRUE(failure.guard([] {}));
  EXPECT_FALSE(failure.get());
  EXPECT_FALSE(failure.guard([] { throw std::runtime_error("disk full"); }));
  EXPECT_FALSE(failure.guard([] { throw std::logic_error("what followed from it"); }));
  EXPECT_THROW(failure.rethrow(), std::runtime_error);
}

}  // namespace
}  // namespace sulcus::feed_thread_test
