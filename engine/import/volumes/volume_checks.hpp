#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>

#include "engine/core/input_limits.hpp"
#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

// What every reader of volumes asks of a header before it takes memory. All throw InputError;
// `place` names the header's field.

/// What of a text header is read.
inline constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;

/// Product of the sizes. Throws where one is not positive or the product exceeds what the limits
/// allow.
std::uint64_t checked_voxel_count(const std::string& path, const std::string& place,
                                  std::span<const std::int64_t> sizes, const InputLimits& limits);

/// Throws unless there are three axes; more of one voxel each do not count.
void check_three_axes(const std::string& path, std::span<const std::int64_t> sizes);

/// Throws where a file holds fewer than `least` bytes of data behind its header or, where they are
/// `exact`, more.
enum class DataLength { kAtLeast, kExact };
void check_data_bytes(const std::string& path, std::uint64_t held, std::uint64_t least,
                      DataLength length);

/// Throws unless the value is positive, finite and of a size that a length may have, in any unit.
void check_spacing(const std::string& path, const std::string& place, double spacing);

/// Sets spacing and directions of `volume` from its steps: columns from one voxel to the next along
/// each index, in units of `unit_m`.
void set_steps(MedicalVolume& volume, const std::string& place, const Eigen::Matrix3d& steps,
               double unit_m);

/// slope * value + offset, for each.
void rescale(std::span<float> values, double slope, double offset);

/// Sets `sizes` of three axes and makes room for the values, once their count has been checked.
void set_sizes(MedicalVolume& volume, std::span<const std::int64_t> sizes);

}  // namespace sulcus
