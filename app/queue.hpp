#pragma once

// The queue orders its memory by fences, which ThreadSanitizer does not follow; it says so to the
// sanitizer itself where it can ask for it in clang's way, which GCC 12 does not have.
#if defined(__SANITIZE_THREAD__)
#pragma push_macro("__has_feature")
#undef __has_feature
#define SULCUS_FEATURE_thread_sanitizer 1
#define __has_feature(name) SULCUS_FEATURE_##name
#endif
#include <readerwriterqueue/readerwriterqueue.h>
#if defined(__SANITIZE_THREAD__)
#pragma pop_macro("__has_feature")
#endif

namespace sulcus {

/// Single producer, single consumer, no lock; takes memory only when it is full.
template <class T>
using Queue = moodycamel::ReaderWriterQueue<T>;

}  // namespace sulcus
