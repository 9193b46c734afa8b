#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace sulcus {

/// Runs gnuplot on the commands that `write` puts into a script; they draw one picture of that
/// many pixels, in place of one that was there. Texts of a user's stand in them as for_gnuplot()
/// (engine/core/user_text.hpp) makes them; the picture's path is no part of them. False, and no
/// file, where gnuplot cannot be run or refuses them. @throws as WholeFile does, and
/// std::runtime_error where the picture cannot be written whole.
bool draw_with_gnuplot(const std::string& file_png, int width, int height,
                       const std::function<void(std::FILE* script)>& write);

/// The same of a script's file, which draws one picture on its standard output. `arguments`: what
/// it reads as ARG1, ARG2, ...; they are data, and no text of the script.
bool draw_with_gnuplot(const std::string& file_png, const std::string& script,
                       const std::vector<std::string>& arguments);

}  // namespace sulcus
