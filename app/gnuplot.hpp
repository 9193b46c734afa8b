#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace sulcus {

/// A text for gnuplot, between double quotes.
std::string quoted_for_gnuplot(const std::string& text);

/// Runs gnuplot on the commands that `write` puts into a script; they draw one picture of that
/// many pixels, in place of one that was there. False, and no file, where gnuplot cannot be run or
/// refuses them.
bool draw_with_gnuplot(const std::string& file_png, int width, int height,
                       const std::function<void(std::FILE* script)>& write);

}  // namespace sulcus
