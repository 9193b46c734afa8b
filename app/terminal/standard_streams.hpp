#pragma once

namespace sulcus {

/// At the start of main. A standard stream that is closed would be the next file that is opened,
/// and what is said would go into that: it becomes /dev/null, or the process ends with status 1. A
/// program at the other end that goes away, and a file that may not grow, are errors, not ends.
void make_streams_safe();

/// Whether all that was said is where standard output goes. Who closes a pipe wants no more of it.
bool has_said_all();

}  // namespace sulcus
