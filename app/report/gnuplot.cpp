#include "app/report/gnuplot.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "app/terminal/child_process.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {
namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// With the reason that the system has just given in errno.
[[noreturn]] void refuse_script(const std::string& file_png) {
  throw std::runtime_error(file_png + ": cannot be written: no room for gnuplot's script (" +
                           std::strerror(errno) + ")");
}

/// Whether a picture is there to its end: gnuplot does not say where the disk is full.
bool is_whole_png(const std::string& file) {
  constexpr std::string_view kEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
  const Stream in(std::fopen(file.c_str(), "rb"), std::fclose);
  std::array<char, kEnd.size()> last{};
  return in && std::fseek(in.get(), -static_cast<long>(last.size()), SEEK_END) == 0 &&
         std::fread(last.data(), 1, last.size(), in.get()) == last.size() &&
         std::string_view(last.data(), last.size()) == kEnd;
}

/// Runs gnuplot with these arguments, the picture on its standard output. False, and no file, where
/// it cannot be run or refuses what it is told. What it says of a script goes nowhere.
bool run_gnuplot(const std::string& file_png, std::vector<std::string> arguments, int input) {
  WholeFile picture(file_png);
  const Stream output(std::fopen(picture.beside().c_str(), "wb"), std::fclose);
  if (!output) picture.fail_incomplete();
  // -d: without the user's own settings.
  arguments.insert(arguments.begin(), {"gnuplot", "-d"});
  int status = 0;
  try {
    ChildProcess gnuplot(arguments, {input, fileno(output.get()), -1});
    status = gnuplot.wait();
  } catch (const std::runtime_error&) {  // it is not there
    return false;
  }
  constexpr int kSignalled = 128;  // by SIGXFSZ, where a file may not grow
  if (status > kSignalled || (status == 0 && !is_whole_png(picture.beside()))) {
    picture.fail_incomplete("gnuplot left it in part");
  }
  if (status != 0) return false;
  picture.finish();
  return true;
}

}  // namespace

bool draw_with_gnuplot(const std::string& file_png, int width, int height,
                       const std::function<void(std::FILE* gnuplot)>& write) {
  // By a file that it opens by name: gnuplot reads what it is given as "-" byte by byte.
  const Stream script(std::tmpfile(), std::fclose);
  if (!script) refuse_script(file_png);
  // The picture comes out of its standard output, so that no path stands in the script.
  std::fprintf(script.get(),
               "set terminal pngcairo size %d,%d rounded noenhanced font 'sans,11' background "
               "'#ffffff'\nset output\n",
               width, height);
  write(script.get());
  std::fputs("\nunset output\n", script.get());
  if (std::fflush(script.get()) != 0 || std::ferror(script.get())) refuse_script(file_png);
  return run_gnuplot(file_png, {"/dev/stdin"}, fileno(script.get()));
}

bool draw_with_gnuplot(const std::string& file_png, const std::string& script,
                       const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"-c", script};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_gnuplot(file_png, std::move(all), -1);
}

}  // namespace sulcus
