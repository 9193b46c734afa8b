#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "tests/support/scratch_folder.hpp"

// What a TIFF says of its pages, and how it may be cut off or packed.

namespace sulcus::tiff_volume_test {
namespace {

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

/// 4 x 5 grey values of 16 bits.
struct Page {
  int first_value = 0;
  std::string description;
  std::map<std::uint16_t, std::uint32_t> tags;  // besides those of a plain page, or in their place
  bool tiled = false;
  bool pack_bits = false;
};

std::string pixels_of(const Page& page) {
  std::string data;
  for (int v = 0; v < 20; ++v) {
    if (page.pack_bits && v % 4 == 0) data += '\7';  // 8 bytes as they are
    data += bytes_of(static_cast<std::uint16_t>(page.first_value + v));
  }
  return data;
}

/// Each page's directory stands behind its pixels, so that a pointer to the next ends the file.
std::string tiff(const std::vector<Page>& pages, bool big = false) {
  const auto offset = [&](std::size_t at) {
    return big ? bytes_of(std::uint64_t{at}) : bytes_of(static_cast<std::uint32_t>(at));
  };
  std::string file =
      big ? std::string("II+\0\10\0\0\0", 8) + offset(0) : std::string("II*\0", 4) + offset(0);
  std::size_t pointer_at = big ? 8 : 4;
  for (const Page& page : pages) {
    const std::size_t data_at = file.size();
    const std::string data = pixels_of(page), text = page.description + '\0';
    file += data;
    const std::size_t text_at = file.size();
    file += text + std::string(text.size() % 2 + data.size() % 2, '\0');
    std::map<std::uint16_t, std::uint32_t> tags{
        {256, 4}, {257, 5}, {258, 16}, {259, page.pack_bits ? 32773 : 1}, {262, 1}, {277, 1}};
    const auto at = static_cast<std::uint32_t>(data_at);
    const auto held = static_cast<std::uint32_t>(data.size());
    if (page.tiled) {
      tags.insert({{324, at}, {325, held}});
    } else {
      tags.insert({{273, at}, {278, 5}, {279, held}});
    }
    if (!page.description.empty()) tags[270] = static_cast<std::uint32_t>(text_at);
    for (const auto& [tag, value] : page.tags) tags[tag] = value;
    file.replace(pointer_at, offset(0).size(), offset(file.size()));
    file += big ? bytes_of(std::uint64_t{tags.size()})
                : bytes_of(static_cast<std::uint16_t>(tags.size()));
    for (const auto& [tag, value] : tags) {
      const std::size_t count = tag == 270 ? text.size() : 1;
      file +=
          bytes_of(tag) + bytes_of(std::uint16_t{tag == 270 ? std::uint16_t{2} : std::uint16_t{4}});
      file += offset(count) + offset(value);
    }
    pointer_at = file.size();
    file += offset(0);
  }
  return file;
}

/// Six pages that count on; the first says what they are.
std::vector<Page> six(const std::string& description = "") {
  std::vector<Page> pages(6);
  for (int k = 0; k < 6; ++k) pages[static_cast<std::size_t>(k)].first_value = 20 * k;
  pages[0].description = description;
  return pages;
}

std::string ome(const std::string& attributes, const std::string& within = "<TiffData/>") {
  return "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org\"><Image><Pixels " +
         attributes + ">" + within + "</Pixels></Image></OME>";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string error_of(const std::string& path) {
  try {
    (void)read_medical_volume(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_counting(const MedicalVolume& volume) {
  ASSERT_EQ(volume.sizes, Eigen::Vector3i(4, 5, 6));
  for (int v = 0; v < 120; ++v) ASSERT_EQ(volume.values[static_cast<std::size_t>(v)], v);
}

const std::string kSizes =
    R"(SizeZ="6" SizeC="1" SizeT="1" PhysicalSizeX="100" PhysicalSizeY="200" PhysicalSizeZ="300")";

TEST(TiffVolume, OmeSlicesInTheOrderOfPagesAlone) {
  const ScratchFolder folder;
  const auto in_order = [](const std::array<int, 6>& slices) {
    std::string data;
    for (int page = 0; page < 6; ++page) {
      data += "<TiffData IFD=\"" + std::to_string(page) + "\" FirstZ=\"" +
              std::to_string(slices[static_cast<std::size_t>(page)]) + "\" PlaneCount=\"1\"/>";
    }
    return tiff(six(ome(kSizes, data)));
  };
  expect_counting(read_medical_volume(folder.write("even.tif", in_order({0, 1, 2, 3, 4, 5}))));
  const std::string reversed = folder.write("reversed.tif", in_order({5, 4, 3, 2, 1, 0}));
  EXPECT_EQ(error_of(reversed), reversed +
                                    ": TiffData: found slice 5 of the stack on page 0, expected "
                                    "pages in the order of the slices");
  EXPECT_NE(error_of(folder.write("woven.tif", in_order({0, 3, 1, 4, 2, 5})))
                .find("TiffData: found slice 3 of the stack on page 1"),
            std::string::npos);
  EXPECT_NE(error_of(folder.write("wrong.tif",
                                  tiff(six(ome(kSizes, "<TiffData IFD=\"0\" FirstZ=\"one\"/>")))))
                .find("ImageDescription: found FirstZ \"one\", expected a whole number"),
            std::string::npos);
}

/// Ways to write the same XML.
std::vector<std::string> spellings(const std::string& text) {
  return {text,
          replaced(text, "\"", "'"),
          replaced(replaced(replaced(text, "</", "</o:"), "<Pi", "<o:Pi"), "<OME xmlns",
                   "<o:OME xmlns:o"),
          replaced(text, " ", "\n\t"),
          replaced(replaced(text, "Pixels SizeZ", "Pixels Name=\"a>b\" SizeZ"), "=\"", " = \""),
          replaced(text, "<Image>", "<!-- <Pixels SizeZ=\"3\" SizeC=\"9\"> --><Image>"),
          replaced(text, "</OME>",
                   "<StructuredAnnotations><Pixels SizeZ=\"3\"/></StructuredAnnotations></OME>"),
          replaced(text, "\"6\"", "\" &#54;\"")};
}

TEST(TiffVolume, OmeIsReadHoweverItsXmlIsWritten) {
  const ScratchFolder folder;
  for (const std::string& text : spellings(ome(kSizes))) {
    SCOPED_TRACE(text);
    const MedicalVolume volume = read_medical_volume(folder.write("a.tif", tiff(six(text))));
    expect_counting(volume);
    EXPECT_TRUE(volume.spacing_known);
    EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-9));
  }
  for (const std::string& text : spellings(ome("SizeZ=\"3\" SizeC=\"2\" SizeT=\"1\""))) {
    EXPECT_NE(error_of(folder.write("a.tif", tiff(six(text))))
                  .find("ImageDescription: found several channels or points in time"),
              std::string::npos)
        << text;
  }
  const std::string whole = ome(kSizes);
  EXPECT_NE(error_of(folder.write("a.tif", tiff(six(whole.substr(0, whole.find(" SizeT"))))))
                .find("ImageDescription: found OME's XML, damaged or broken off"),
            std::string::npos);
}

TEST(TiffVolume, UnitsOfLength) {
  const ScratchFolder folder;
  const auto in_unit = [&](const std::string& unit) {
    std::string sizes = kSizes;
    for (const std::string axis : {"X", "Y", "Z"}) {
      sizes += " PhysicalSize" + axis + "Unit=\"" + unit + "\"";
    }
    return folder.write("a.tif", tiff(six(ome(sizes))));
  };
  const std::map<std::string, double> units{
      {"millimeters", 1e-3},  {"Millimetre", 1e-3}, {"micrometers", 1e-6}, {"meter", 1.0},
      {"\xc3\x85", 1e-10},    {"&#197;", 1e-10},    {"&#181;m", 1e-6},     {"&#xB5;m", 1e-6},
      {"&#xb5;m", 1e-6},      {" mm\n", 1e-3},      {"nanometers", 1e-9},  {"inches", 25.4e-3},
      {"\xe2\x84\xab", 1e-10}};
  for (const auto& [unit, unit_m] : units) {
    const MedicalVolume volume = read_medical_volume(in_unit(unit));
    EXPECT_TRUE(volume.spacing_known) << unit;
    EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(100, 200, 300) * unit_m, 1e-9)) << unit;
  }
  EXPECT_FALSE(read_medical_volume(in_unit("reference frame")).spacing_known);
  EXPECT_NE(error_of(in_unit("a &lt;cubit&gt;")).find("unit: found \"a <cubit>\", expected mm"),
            std::string::npos);
}

TEST(TiffVolume, EachFileOfAFolderIsOneStack) {
  const ScratchFolder folder;
  const auto write = [&](const std::string& name, const std::vector<std::string>& descriptions) {
    for (std::size_t k = 0; k < 6; ++k) {
      const Page page{.first_value = 20 * static_cast<int>(k),
                      .description = descriptions[k % descriptions.size()],
                      .tags = {}};
      folder.write(name + "/s" + std::to_string(k) + ".tif", tiff({page}));
    }
    return folder.path(name);
  };
  const auto says = [](const std::string& error, const std::string& text) {
    EXPECT_NE(error.find(text), std::string::npos) << error;
  };
  says(error_of(write("image_j", {"", "ImageJ=1.53t\nimages=2\nchannels=2\n"})),
       "s1.tif: ImageDescription: found several channels");
  says(error_of(write("ome", {"", "", ome("SizeZ=\"1\" SizeC=\"2\"")})),
       "s2.tif: ImageDescription: found several channels");
  says(error_of(write("fewer", {"ImageJ=1.53t\nimages=2\n"})),
       "s0.tif: ImageDescription: found 2 slices, expected 1");
  // Each with the description of the whole, and one without a unit of length that is known.
  expect_counting(read_medical_volume(write("whole", {"ImageJ=1.53t\nimages=6\nunit=cubit\n"})));
  const auto set = [&](bool reversed) {
    std::string blocks;
    for (int k = 0; k < 6; ++k) {
      blocks += "<TiffData IFD=\"0\" FirstZ=\"" + std::to_string(reversed ? 5 - k : k) +
                "\"><UUID FileName=\"s" + std::to_string(k) + ".tif\">urn</UUID></TiffData>";
    }
    return ome(kSizes, blocks);
  };
  expect_counting(read_medical_volume(write("set", {set(false)})));
  says(error_of(write("reversed", {set(true)})), "s0.tif: TiffData: found slice 5 of the stack");
}

TEST(TiffVolume, APageWhosePointerToTheNextIsCutOffIsRefused) {
  const ScratchFolder folder;
  for (const bool big : {false, true}) {
    std::vector<Page> pages = six();
    const std::size_t size_of_six = tiff(pages, big).size();
    const std::size_t page_bytes = (size_of_six - (big ? 16 : 8)) / 6, pointer = big ? 8 : 4;
    const std::string whole = tiff(pages, big);
    expect_counting(read_medical_volume(folder.write("whole.tif", whole)));
    for (const std::size_t held : {std::size_t{2}, std::size_t{5}}) {
      for (std::size_t cut = 1; cut <= pointer; ++cut) {
        const std::string path =
            folder.write("cut.tif", whole.substr(0, size_of_six - held * page_bytes - cut));
        const std::string error = error_of(path);
        EXPECT_TRUE(error.starts_with(path)) << error << ", " << cut;
      }
    }
    const std::string last = folder.write("last.tif", whole.substr(0, size_of_six - 3));
    EXPECT_NE(error_of(last).find(": page 5: found a page that "), std::string::npos) << big;
  }
}

TEST(TiffVolume, DeepPagesAreRefused) {
  const ScratchFolder folder;
  Page deep;
  deep.tags[32997] = 3;
  EXPECT_NE(error_of(folder.write("deep.tif", tiff({deep})))
                .find("page 0: found an ImageDepth of 3, expected a page for each slice"),
            std::string::npos);
}

TEST(TiffVolume, TheShapeOfAnArrayIsThatOfThePages) {
  const ScratchFolder folder;
  const auto shaped = [&](const std::string& shape, std::size_t pages) {
    std::vector<Page> all = six("{\"truncated\": true, \"shape\": [" + shape + "]}");
    all.resize(pages);
    return folder.write("a.tif", tiff(all));
  };
  EXPECT_NE(error_of(shaped("6, 5, 4", 1))
                .find("ImageDescription: found a shape of more pixels than there are, expected "
                      "that of the pages, which are 1"),
            std::string::npos);
  EXPECT_NE(error_of(shaped("2, 3, 5, 4", 6)).find("found several channels"), std::string::npos);
  expect_counting(read_medical_volume(shaped("6, 5, 4", 6)));
  expect_counting(read_medical_volume(shaped("1, 6, 1, 5, 4, 1", 6)));
  expect_counting(read_medical_volume(shaped("5, 4", 6)));  // written page by page
}

TEST(TiffVolume, TilesFarBeyondThePictureAreRefused) {
  const ScratchFolder folder;
  Page tile;
  tile.tiled = true;
  tile.tags = {{322, 16384}, {323, 16384}};
  EXPECT_NE(error_of(folder.write("a.tif", tiff({tile})))
                .find("page 0: found tiles of 16384 x 16384, expected tiles of the size of the "
                      "picture"),
            std::string::npos);
}

TEST(TiffVolume, PagesMayBePackedDifferently) {
  const ScratchFolder folder;
  std::vector<Page> pages = six();
  pages[1].pack_bits = pages[4].pack_bits = true;
  expect_counting(read_medical_volume(folder.write("a.tif", tiff(pages))));
  pages[3].tags[262] = 0;  // 0 is white
  EXPECT_NE(
      error_of(folder.write("b.tif", tiff(pages))).find("page 3: found a page of another form"),
      std::string::npos);
}

}  // namespace
}  // namespace sulcus::tiff_volume_test
