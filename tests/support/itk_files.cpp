#include "tests/support/itk_files.hpp"

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <itkGDCMImageIO.h>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

namespace sulcus::test {
namespace {

itk::ImageIOBase::Pointer io_of(const std::string& path) {
  const auto ends = [&](const char* extension) { return path.ends_with(extension); };
  if (ends(".nrrd") || ends(".nhdr")) return itk::NrrdImageIO::New().GetPointer();
  if (ends(".mha") || ends(".mhd")) return itk::MetaImageIO::New().GetPointer();
  if (ends(".nii") || ends(".nii.gz")) return itk::NiftiImageIO::New().GetPointer();
  if (ends(".tif")) return itk::TIFFImageIO::New().GetPointer();
  if (ends(".png")) return itk::PNGImageIO::New().GetPointer();
  if (ends(".dcm")) return itk::GDCMImageIO::New().GetPointer();
  throw std::runtime_error(path + ": no format of these tests");
}

/// The first `dimensions` axes of a volume, from `values` on.
void write(itk::ImageIOBase& io, const std::string& path, const PlainVolume& volume,
           unsigned dimensions, const std::uint16_t* values) {
  io.SetFileName(path);
  io.SetFileTypeToBinary();
  io.SetNumberOfDimensions(dimensions);
  io.SetPixelType(itk::IOPixelEnum::SCALAR);
  io.SetComponentType(itk::IOComponentEnum::USHORT);
  io.SetNumberOfComponents(1);
  itk::ImageIORegion region(dimensions);
  for (unsigned d = 0; d < dimensions; ++d) {
    const auto size = static_cast<itk::SizeValueType>(volume.sizes[d]);
    io.SetDimensions(d, size);
    io.SetSpacing(d, volume.spacing_mm[d]);
    io.SetOrigin(d, volume.origin_mm[d]);
    io.SetDirection(
        d, std::vector<double>(volume.axes[d].begin(), volume.axes[d].begin() + dimensions));
    region.SetIndex(d, 0);
    region.SetSize(d, size);
  }
  io.SetIORegion(region);
  io.Write(values);
}

std::string joined(std::initializer_list<double> values) {
  std::ostringstream text;
  text.precision(12);
  const char* between = "";
  for (const double v : values) {
    text << between << v;
    between = "\\";
  }
  return text.str();
}

void tell_place(itk::MetaDataDictionary& tags, const PlainVolume& volume, int slice) {
  const auto set = [&](const char* tag, const std::string& value) {
    itk::EncapsulateMetaData<std::string>(tags, tag, value);
  };
  const auto& x = volume.axes[0];
  const auto& y = volume.axes[1];
  std::array<double, 3> at = volume.origin_mm;
  for (std::size_t d = 0; d < 3; ++d) at[d] += slice * volume.spacing_mm[2] * volume.axes[2][d];
  set("0008|0060", "CT");
  set("0020|000d", "1.2.3.5");
  set("0020|000e", "1.2.3.6");
  set("0020|0013", std::to_string(slice + 1));
  set("0020|0032", joined({at[0], at[1], at[2]}));
  set("0020|0037", joined({x[0], x[1], x[2], y[0], y[1], y[2]}));
  set("0028|0030", joined({volume.spacing_mm[1], volume.spacing_mm[0]}));
}

}  // namespace

void write_with_itk(const std::string& path, const PlainVolume& volume) {
  write(*io_of(path), path, volume, 3, volume.values.data());
}

void write_slices_with_itk(const std::string& folder, const std::string& extension,
                           const PlainVolume& volume) {
  std::filesystem::create_directories(folder);
  const std::size_t pixels =
      static_cast<std::size_t>(volume.sizes[0]) * static_cast<std::size_t>(volume.sizes[1]);
  for (int slice = 0; slice < volume.sizes[2]; ++slice) {
    const std::string name = folder + "/slice_" + std::to_string(slice + 1) + extension;
    const itk::ImageIOBase::Pointer io = io_of(name);
    if (extension == ".dcm") {
      tell_place(io->GetMetaDataDictionary(), volume, slice);
      dynamic_cast<itk::GDCMImageIO&>(*io).KeepOriginalUIDOn();
      itk::EncapsulateMetaData<std::string>(io->GetMetaDataDictionary(), "0008|0018",
                                            "1.2.3.4." + std::to_string(slice + 1));
    }
    write(*io, name, volume, 2, volume.values.data() + static_cast<std::size_t>(slice) * pixels);
  }
}

}  // namespace sulcus::test
