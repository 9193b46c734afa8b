#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>

#ifdef SULCUS_STD_THREADS
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace sulcus {

// Loops whose rounds do not depend on each other, for loading: on oneTBB's threads, or, where the
// build has none (SULCUS_STD_THREADS), on threads of the standard library. Who calls is one of them
// and returns when all is done. Which thread does what is not said, so results must not hang on it.

/// Calls `body(low, high)` for ranges of about `grain` that together are [begin, end).
/// What a call throws is thrown here, the first of several.
template <class Index, class Body>
void parallel_ranges(Index begin, Index end, Index grain, const Body& body) {
  if (begin >= end) return;
#ifdef SULCUS_STD_THREADS
  std::atomic<std::size_t> next{0};
  const auto size = static_cast<std::size_t>(end - begin);
  const auto step = std::max<std::size_t>(static_cast<std::size_t>(grain), 1);
  const std::size_t pieces = (size + step - 1) / step;
  std::exception_ptr failure;
  std::mutex failing;
  const auto work = [&] {
    for (std::size_t n = next++; n < pieces; n = next++) {
      try {
        body(static_cast<Index>(begin + static_cast<Index>(n * step)),
             static_cast<Index>(begin + static_cast<Index>(std::min(size, (n + 1) * step))));
      } catch (...) {
        const std::lock_guard lock(failing);
        if (!failure) failure = std::current_exception();
        next = pieces;
      }
    }
  };
  std::vector<std::thread> others;
  const std::size_t wanted = std::min<std::size_t>(std::thread::hardware_concurrency(), pieces);
  others.reserve(wanted);
  try {
    for (std::size_t t = 1; t < wanted; ++t) others.emplace_back(work);
  } catch (const std::exception&) {  // the system has no more: those that run do the work
  }
  work();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
#else
  tbb::parallel_for(tbb::blocked_range<Index>(begin, end, static_cast<std::size_t>(grain)),
                    [&](const auto& range) { body(range.begin(), range.end()); });
#endif
}

/// Calls `body(i)` for every i of [begin, end).
template <class Index, class Body>
void parallel_for(Index begin, Index end, const Body& body) {
#ifdef SULCUS_STD_THREADS
  parallel_ranges(begin, end, Index{1}, [&](Index low, Index high) {
    for (Index i = low; i != high; ++i) body(i);
  });
#else
  if (begin < end) tbb::parallel_for(begin, end, body);
#endif
}

}  // namespace sulcus
