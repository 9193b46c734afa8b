#include "app/gnuplot.hpp"

#include <cstdlib>
#include <filesystem>

namespace sulcus {

std::string quoted_for_gnuplot(const std::string& text) {
  std::string safe = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe + "\"";
}

bool draw_with_gnuplot(const std::string& file_png, int width, int height,
                       const std::function<void(std::FILE* gnuplot)>& write) {
  std::error_code ignored;
  std::filesystem::remove(file_png, ignored);
  // By a file: gnuplot reads a pipe byte by byte.
  std::FILE* script = std::tmpfile();
  if (!script) return false;
  std::fprintf(script,
               "set terminal pngcairo size %d,%d rounded noenhanced font 'sans,11' background "
               "'#ffffff'\nset output %s\n",
               width, height, quoted_for_gnuplot(file_png).c_str());
  write(script);
  bool drawn = std::fflush(script) == 0 && std::ferror(script) == 0;
  if (drawn) {
    const std::string command =
        "gnuplot /dev/fd/" + std::to_string(fileno(script)) + " >/dev/null 2>&1";
    drawn = std::system(command.c_str()) == 0;
  }
  std::fclose(script);
  return drawn && std::filesystem::exists(file_png, ignored);
}

}  // namespace sulcus
