#include "engine/import/volumes/itk_volume_writer.hpp"

#include <iostream>
#include <stdexcept>
#include <string_view>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include "engine/core/file_kind.hpp"
#include "engine/core/whole_file.hpp"

// With itk_thresholds.cpp the only file that knows ITK. It writes; what files say is read by
// readers of our own, since ITK 5.2 changes some of it in silence.

namespace sulcus {
namespace {

using IOComponent = itk::IOComponentEnum;

constexpr double kUnitOfItk = 1e-3;  // m: medical files are in mm

/// ITK and the writers in it talk to `std::cerr` besides throwing; an error here is one line.
class Silence {
 public:
  Silence() : warnings_(itk::Object::GetGlobalWarningDisplay()), buffer_(std::cerr.rdbuf(nullptr)) {
    itk::Object::GlobalWarningDisplayOff();
  }
  ~Silence() {
    std::cerr.rdbuf(buffer_);  // clears the state, too
    itk::Object::SetGlobalWarningDisplay(warnings_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  bool warnings_;
  std::streambuf* buffer_;
};

/// ITK's text on one line, without the object's name and address that it begins with.
std::string one_line(const itk::ExceptionObject& error) {
  std::string_view text = error.GetDescription();
  if (const auto address = text.find("(0x"); address != std::string_view::npos) {
    if (const auto end = text.find("): ", address); end != std::string_view::npos) {
      text.remove_prefix(end + 3);
    }
  }
  // NrrdIO tells the whole chain of its calls; the last of them knows the reason.
  if (const auto last = text.rfind("[nrrd] "); last != std::string_view::npos) {
    text.remove_prefix(last + 7);
  }
  std::string line;
  for (const char c : text) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  constexpr std::size_t kLongest = 200;
  if (line.size() > kLongest) line = line.substr(0, kLongest) + "...";
  return line.empty() ? "unreadable contents" : "unreadable contents (" + line + ")";
}

/// Null: no format that is written.
itk::ImageIOBase::Pointer writer_of(const std::string& extension) {
  if (extension == ".nrrd") return itk::NrrdImageIO::New().GetPointer();
  if (extension == ".mha") return itk::MetaImageIO::New().GetPointer();
  if (extension == ".nii.gz") return itk::NiftiImageIO::New().GetPointer();
  return nullptr;
}

}  // namespace

void write_volume_with_itk(const std::string& path, const ItkMask& mask) {
  WholeFile file(path);
  const Silence silence;
  try {
    const itk::ImageIOBase::Pointer io = writer_of(lower_extension(path));
    if (!io) throw std::logic_error(path + ": no format that is written");
    io->SetFileName(file.beside());
    io->SetFileTypeToBinary();
    io->SetUseCompression(true);
    io->SetNumberOfDimensions(3);
    io->SetPixelType(itk::IOPixelEnum::SCALAR);
    io->SetComponentType(IOComponent::UCHAR);
    io->SetNumberOfComponents(1);
    itk::ImageIORegion region(3);
    for (unsigned d = 0; d < 3; ++d) {
      const auto size = static_cast<itk::SizeValueType>(mask.sizes[d]);
      io->SetDimensions(d, size);
      io->SetSpacing(d, mask.spacing_m[d] / kUnitOfItk);
      io->SetOrigin(d, mask.origin_m[d] / kUnitOfItk);
      io->SetDirection(d, std::vector<double>(mask.axes[d].begin(), mask.axes[d].end()));
      region.SetIndex(d, 0);
      region.SetSize(d, size);
    }
    io->SetIORegion(region);
    io->Write(mask.voxels.data());
  } catch (const itk::ExceptionObject& itk_error) {
    file.fail_incomplete(one_line(itk_error));
  }
  if (!is_whole_volume(file.beside(), mask.voxels.size())) file.fail_incomplete();
  file.finish();
}

}  // namespace sulcus
