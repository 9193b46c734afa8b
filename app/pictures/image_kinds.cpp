#include "app/pictures/image_kinds.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/graphics/shown_voxel.hpp"

namespace sulcus {

ImageKinds::ImageKinds(std::span<const std::string> words) {
  const auto has = [&](std::string_view kind) {
    return words.empty() || std::ranges::find(words, kind) != words.end();
  };
  colour = has("colour");
  depth = has("depth");
  labels = has("labels");
  normals = has("normals");
  contact = has("contact");
}

std::size_t ImageKinds::count() const {
  std::size_t count = 0;
  for (const bool asked : {colour, depth, labels, normals, contact}) count += asked ? 1u : 0u;
  return count;
}

std::vector<ImageLabel> label_table(const Scene& scene) {
  if (scene.tissues.size() > kHandpieceLabel) {
    throw InputError(scene.file, "--kind", std::to_string(scene.tissues.size()) + " tissues",
                     "at most 253, so that labels are left for what is no tissue");
  }
  std::vector<ImageLabel> table;
  table.reserve(scene.tissues.size() + 3);
  for (const TissueSettings& tissue : scene.tissues) {
    table.push_back({static_cast<std::uint8_t>(table.size()), tissue.name});
  }
  table.push_back({kHandpieceLabel, "handpiece"});
  table.push_back({kBurrLabel, "burr"});
  table.push_back({kBackgroundLabel, "background"});
  return table;
}

std::vector<std::uint8_t> labels_of(const Scene& scene, const GlScene& drawing,
                                    const GeometryImage& image,
                                    std::span<const std::uint32_t> voxels) {
  std::vector<std::uint8_t> labels(voxels.size(), kBackgroundLabel);
  for (std::size_t pixel = 0; pixel < voxels.size(); ++pixel) {
    const ShownObject shown = image.object(pixel);
    if (shown.kind == ShownObject::Kind::kBurr) labels[pixel] = kBurrLabel;
    if (shown.kind == ShownObject::Kind::kHandpiece) labels[pixel] = kHandpieceLabel;
    if (voxels[pixel] == kNoVoxel) continue;
    const std::size_t body = shown.kind == ShownObject::Kind::kPiece ? 0 : shown.index;
    if (body > 0 && scene.bodies[body - 1].tissue) {
      labels[pixel] = static_cast<std::uint8_t>(*scene.bodies[body - 1].tissue);
      continue;
    }
    const VoxelModel& model = drawing.surface(body).model();
    labels[pixel] = model.tissue(model.grid.cell_of_linear(voxels[pixel]));
  }
  return labels;
}

std::vector<std::uint8_t> contacts_of(const GeometryImage& image,
                                      std::span<const std::uint32_t> voxels,
                                      std::span<const RecordedContacts::Voxel> in_contact) {
  std::set<std::pair<std::size_t, std::uint32_t>> touched;
  for (const RecordedContacts::Voxel& voxel : in_contact) {
    touched.emplace(voxel.body, voxel.voxel);
  }
  std::vector<std::uint8_t> contacts(voxels.size(), 0);
  if (touched.empty()) return contacts;
  for (std::size_t pixel = 0; pixel < voxels.size(); ++pixel) {
    if (voxels[pixel] == kNoVoxel) continue;
    const ShownObject shown = image.object(pixel);
    if (shown.kind == ShownObject::Kind::kPiece) continue;  // it is no body of the contact any more
    contacts[pixel] = touched.contains({shown.index, voxels[pixel]}) ? 1 : 0;
  }
  return contacts;
}

}  // namespace sulcus
