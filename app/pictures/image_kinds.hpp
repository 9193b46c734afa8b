#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/playback/recorded_contacts.hpp"
#include "engine/graphics/geometry_image.hpp"
#include "engine/graphics/image.hpp"
#include "engine/graphics/pinhole.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/recording/image_set_file.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// What a pixel can be asked for.
inline constexpr std::array<std::string_view, 5> kImageKinds{"colour", "depth", "labels", "normals",
                                                             "contact"};

/// Those that are asked for; all where `words` is empty.
struct ImageKinds {
  bool colour = false, depth = false, labels = false, normals = false, contact = false;

  explicit ImageKinds(std::span<const std::string> words);
  std::size_t count() const;
};

// Labels of what is no tissue. Those of tissues are the volume's, their places in the scene.
inline constexpr std::uint8_t kHandpieceLabel = 253, kBurrLabel = 254, kBackgroundLabel = 255;

/// All labels that pictures of a scene can have. InputError where its tissues leave none for what
/// is no tissue.
std::vector<ImageLabel> label_table(const Scene& scene);

/// Of each pixel. `voxels`: shown_voxels of the image.
std::vector<std::uint8_t> labels_of(const Scene& scene, const GlScene& drawing,
                                    const GeometryImage& image,
                                    std::span<const std::uint32_t> voxels);

/// 1 where a pixel shows a voxel that is in contact; 0 elsewhere.
std::vector<std::uint8_t> contacts_of(const GeometryImage& image,
                                      std::span<const std::uint32_t> voxels,
                                      std::span<const RecordedContacts::Voxel> in_contact);

/// All that was asked for of one camera at one time; what was not is empty.
struct ImageFrame {
  std::string camera;     // fit for the name of a file and of a group
  std::size_t frame = 0;  // number of the time
  double time_s = 0.0;
  std::uint64_t tick = 0;
  Pinhole pinhole;
  Image colour;
  GeometryImage geometry;
  std::vector<std::uint8_t> labels, contact;
};

}  // namespace sulcus
