#include "app/stream/tooth_messages.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <igtlImageMessage.h>
#include <igtl_header.h>
#include <igtl_polydata.h>
#include <igtl_util.h>
#include <oneapi/tbb/task_arena.h>

#include "engine/core/units.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

/// Cuts off what a header has no room for.
template <std::size_t kSize>
void put_text(const std::string& text, char (&field)[kSize]) {
  std::memset(field, 0, kSize);
  std::memcpy(field, text.data(), std::min(text.size(), kSize));
}

/// Writes the header before a body that lies in its place.
void put_header(const std::string& type, const std::string& name, MessageTime time,
                std::vector<std::byte>& message) {
  auto* body = reinterpret_cast<unsigned char*>(message.data()) + IGTL_HEADER_SIZE;
  igtl_header header{};
  header.version = IGTL_HEADER_VERSION;
  put_text(type, header.name);
  put_text(name, header.device_name);
  header.timestamp = time.stamp();
  header.body_size = message.size() - IGTL_HEADER_SIZE;
  header.crc = crc64(body, header.body_size, crc64(nullptr, 0, 0));
  igtl_header_convert_byte_order(&header);
  std::memcpy(message.data(), &header, sizeof(header));
}

StreamBytes shared(std::vector<std::byte> bytes) {
  return std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

/// The cells from the first to before the second hold all that is solid, by whole leaves.
std::pair<Cell, Cell> solid_box(const VoxelModel& model) {
  Cell low = model.grid.cells, high = Cell::Zero();
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    const Cell begin = model.grid.leaf_origin(leaf);
    low = low.cwiseMin(begin);
    high = high.cwiseMax(begin + Cell::Constant(kLeafEdge));
  }
  return {low, high};
}

}  // namespace

// By the library's functions in C: its classes take a list of its own for each triangle.
StreamBytes tooth_polydata(const VoxelModel& model, const std::string& name, MessageTime time) {
  TriangleMesh mesh;
  // On this thread: the others of oneTBB would share the processor with the ticks.
  oneapi::tbb::task_arena here(1);
  here.execute([&] { mesh = closed_surface(model); });
  if (mesh.triangles.empty()) return no_data("POLYDATA", name);

  std::vector<igtl_float32> points_mm;
  points_mm.reserve(3 * mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) points_mm.push_back(p[axis] * 1e3f);
  }
  std::vector<igtl_uint32> polygons;
  polygons.reserve(4 * mesh.triangles.size());
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    polygons.push_back(3);
    polygons.insert(polygons.end(), corners.begin(), corners.end());
  }
  igtl_polydata_info info;
  igtl_polydata_init_info(&info);
  info.header.npoints = static_cast<igtl_uint32>(mesh.positions.size());
  info.header.npolygons = static_cast<igtl_uint32>(mesh.triangles.size());
  info.header.size_polygons = static_cast<igtl_uint32>(polygons.size() * sizeof(igtl_uint32));
  info.points = points_mm.data();
  info.polygons = polygons.data();
  mesh = {};
  std::vector<std::byte> message(IGTL_HEADER_SIZE +
                                 igtl_polydata_get_size(&info, IGTL_TYPE_PREFIX_NONE));
  igtl_polydata_pack(&info, message.data() + IGTL_HEADER_SIZE, IGTL_TYPE_PREFIX_NONE);
  put_header("POLYDATA", name, time, message);
  return shared(std::move(message));
}

StreamBytes tooth_image(const VoxelModel& model, const std::string& name, MessageTime time) {
  const auto [low, high] = solid_box(model);
  if ((high.array() <= low.array()).any()) return no_data("IMAGE", name);
  const Cell size = high - low;
  const Eigen::Vector3d middle_mm =
      model.grid.world_from_index(0.5 * (low + high - Cell::Ones()).cast<double>()) / kMillimetre;
  const auto spacing_mm = static_cast<float>(model.grid.voxel_m / kMillimetre);
  const auto image = igtl::ImageMessage::New();
  image->SetDeviceName(name.c_str());
  image->SetTimeStamp(time.seconds, time.fraction);
  image->SetDimensions(size.x(), size.y(), size.z());
  image->SetSpacing(spacing_mm, spacing_mm, spacing_mm);
  image->SetOrigin(static_cast<float>(middle_mm.x()), static_cast<float>(middle_mm.y()),
                   static_cast<float>(middle_mm.z()));
  image->SetScalarTypeToUint8();
  image->SetCoordinateSystem(igtl::ImageMessage::COORDINATE_RAS);
  image->AllocateScalars();
  auto* voxel = static_cast<std::uint8_t*>(image->GetScalarPointer());
  for_each_cell(low, high, [&](const Cell& c) {
    *voxel++ = model.solid(c) ? static_cast<std::uint8_t>(1 + model.tissue(c)) : std::uint8_t{0};
  });
  image->Pack();
  const auto* begin = static_cast<const std::byte*>(image->GetPackPointer());
  return shared({begin, begin + image->GetPackSize()});
}

StreamBytes no_data(const std::string& type, const std::string& name) {
  std::vector<std::byte> message(IGTL_HEADER_SIZE);
  put_header(type, name, {}, message);
  return shared(std::move(message));
}

StreamBytes capability(const std::string& name) {
  constexpr std::array kTypes{"CAPABILITY", "IMAGE", "POLYDATA", "SENSOR", "STATUS", "TRANSFORM"};
  std::vector<std::byte> message(IGTL_HEADER_SIZE + kTypes.size() * IGTL_HEADER_TYPE_SIZE);
  auto* field = reinterpret_cast<char*>(message.data()) + IGTL_HEADER_SIZE;
  for (const std::string type : kTypes) {  // the rest of each stays zero
    std::copy(type.begin(), type.end(), field);
    field += IGTL_HEADER_TYPE_SIZE;
  }
  put_header("CAPABILITY", name, {}, message);
  return shared(std::move(message));
}

}  // namespace sulcus
