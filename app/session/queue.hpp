#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

namespace sulcus {

/// Single producer, single consumer, no lock; takes memory only when it is full.
template <class T>
using Queue = moodycamel::ReaderWriterQueue<T>;

}  // namespace sulcus
