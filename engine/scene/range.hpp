#pragma once

namespace sulcus {

/// A range that a number must lie in, ends included.
struct Range {
  double least, most;
};

}  // namespace sulcus
