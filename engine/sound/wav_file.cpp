#include "engine/sound/wav_file.hpp"

#include <array>
#include <memory>
#include <string>

#include <sndfile.h>

namespace sulcus {

void write_wav(const WholeFile& file, int rate_hz, const TakeSamples& take) {
  SF_INFO info{};
  info.samplerate = rate_hz;
  info.channels = 1;
  info.format = SF_FORMAT_WAV | SF_FORMAT_PCM_16;
  std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> out(sf_open(file.beside().c_str(), SFM_WRITE, &info),
                                                  sf_close);
  const auto fail = [&](const std::string& why) { file.fail_incomplete(why); };
  if (!out) fail(sf_strerror(nullptr));
  sf_command(out.get(), SFC_SET_CLIPPING, nullptr, SF_TRUE);
  std::array<float, 4096> block{};
  for (std::size_t count; (count = take(block)) > 0;) {
    const auto wanted = static_cast<sf_count_t>(count);
    if (sf_writef_float(out.get(), block.data(), wanted) != wanted) fail(sf_strerror(out.get()));
  }
  if (const int error = sf_close(out.release()); error != 0) fail(sf_error_number(error));
}

}  // namespace sulcus
