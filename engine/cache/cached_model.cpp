#include "engine/cache/cached_model.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/volume/packed_model.hpp"

namespace sulcus {
namespace {

constexpr std::uint32_t kClipped = 1, kLabelled = 2, kFilled = 4, kFlags = 7;
constexpr std::uint32_t kFullLeaf = 1u << 31;
constexpr std::uint64_t kFullWord = ~std::uint64_t{0};

struct ModelHeader {
  std::array<std::uint32_t, 3> cells{};
  std::uint32_t flags = 0;
  double voxel_m = 0.0;
  std::uint64_t leaves = 0, part_full = 0, mixed = 0;
  std::uint64_t input_numbers = 0, warning_bytes = 0;
};
static_assert(sizeof(ModelHeader) == 64);
static_assert(sizeof(LeafBits) == 64 && sizeof(LabelBlock) == 512 && sizeof(LeafLevels) == 516);

bool is_full(const LeafBits& leaf) {
  return std::ranges::all_of(leaf.words, [](std::uint64_t w) { return w == kFullWord; });
}

ModelHeader header_of(const VoxelGrid& grid) {
  ModelHeader header;
  for (int a = 0; a < 3; ++a) header.cells[a] = static_cast<std::uint32_t>(grid.cells[a]);
  header.voxel_m = grid.voxel_m;
  return header;
}

/// Takes arrays from a payload, one after another.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}

  /// False where there is less.
  template <class T>
  bool take(std::vector<T>& values, std::uint64_t count) {
    if (count > left_.size() / sizeof(T)) return false;
    values.resize(count);
    const std::size_t bytes = count * sizeof(T);
    if (bytes > 0) std::memcpy(values.data(), left_.data(), bytes);
    left_ = left_.subspan(bytes);
    return true;
  }
  bool ended() const { return left_.empty(); }

 private:
  std::span<const std::byte> left_;
};

constexpr std::uint64_t kMostWarningBytes = 1 << 16;

bool take_notes(Reader& reader, const ModelHeader& header, ImportNotes& notes) {
  std::vector<double> numbers;
  std::vector<char> warnings;
  if ((header.input_numbers != 0 && header.input_numbers != InputGeometry::kNumbers) ||
      header.warning_bytes > kMostWarningBytes || !reader.take(numbers, header.input_numbers) ||
      !reader.take(warnings, header.warning_bytes)) {
    return false;
  }
  if (!numbers.empty()) {
    notes.input = InputGeometry::of(
        std::span<const double, InputGeometry::kNumbers>(numbers.data(), InputGeometry::kNumbers));
    if (!notes.input) return false;
  }
  for (auto begin = warnings.begin(); begin != warnings.end();) {
    const auto end = std::find(begin, warnings.end(), '\n');
    if (end == warnings.end()) return false;
    notes.warnings.emplace_back(begin, end);
    begin = end + 1;
  }
  return true;
}

std::string text_of(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text.append(warning).append("\n");
  return text;
}

bool take_levels(Reader& reader, const ModelHeader& header, std::vector<LeafLevels>& levels) {
  std::vector<std::uint64_t> count;
  return reader.take(count, 1) && count[0] <= header.leaves && reader.take(levels, count[0]);
}

/// Whether pages are of leaves with solid voxels, rising, and fill just those.
bool levels_fit(const PackedModel& packed) {
  auto leaf = packed.leaves.begin();
  for (const LeafLevels& page : packed.levels) {
    leaf = std::lower_bound(leaf, packed.leaves.end(), page.leaf);
    if (leaf == packed.leaves.end() || *leaf != page.leaf) return false;
    const LeafBits& solid = packed.words[static_cast<std::size_t>(leaf - packed.leaves.begin())];
    for (int place = 0; place < 512; ++place) {
      if ((page.levels[static_cast<std::size_t>(place)] != 0) != solid.has(place)) return false;
    }
    ++leaf;
  }
  return true;
}

/// The arrays of a payload as they were packed; empty where they do not fit one another.
std::optional<PackedModel> parse(std::span<const std::byte> payload, const VoxelGrid& grid,
                                 std::size_t tissues, ImportNotes& notes) {
  Reader reader(payload);
  std::vector<ModelHeader> headers;
  if (!reader.take(headers, 1)) return std::nullopt;
  const ModelHeader& header = headers[0];
  const ModelHeader expected = header_of(grid);
  const std::uint32_t leaf_count = grid.leaf_count();
  if (header.cells != expected.cells || header.voxel_m != expected.voxel_m ||
      (header.flags & ~kFlags) != 0 || header.leaves > leaf_count ||
      header.part_full > header.leaves || header.mixed > header.leaves) {
    return std::nullopt;
  }
  PackedModel packed;
  packed.grid = grid;
  packed.clipped = (header.flags & kClipped) != 0;
  packed.labelled = (header.flags & kLabelled) != 0;
  packed.filled = (header.flags & kFilled) != 0;
  std::vector<LeafBits> part_full;
  const bool whole =
      take_notes(reader, header, notes) && reader.take(packed.leaves, header.leaves) &&
      reader.take(packed.mixed, header.mixed) &&
      reader.take(packed.leaf_labels, packed.labelled ? header.leaves : 0) &&
      reader.take(part_full, header.part_full) && reader.take(packed.mixed_labels, header.mixed) &&
      (!packed.filled || take_levels(reader, header, packed.levels)) && reader.ended();
  if (!whole || (!packed.labelled && header.mixed > 0)) return std::nullopt;

  packed.words.resize(packed.leaves.size());
  auto next = part_full.begin();
  for (std::size_t row = 0; row < packed.leaves.size(); ++row) {
    if (packed.leaves[row] & kFullLeaf) {
      packed.leaves[row] &= ~kFullLeaf;
      packed.words[row].words.fill(kFullWord);
    } else if (next == part_full.end() || *next == LeafBits{}) {
      return std::nullopt;
    } else {
      packed.words[row] = *next++;
    }
  }
  const auto named = [&](std::uint8_t label) { return label < tissues; };
  const bool fits = next == part_full.end() && is_rising_below(packed.leaves, leaf_count) &&
                    is_rising_below(packed.mixed, packed.leaves.size()) &&
                    std::ranges::all_of(packed.leaf_labels, named) &&
                    std::ranges::all_of(packed.mixed_labels, [&](const LabelBlock& block) {
                      return std::ranges::all_of(block, named);
                    });
  if (!fits || !levels_fit(packed)) return std::nullopt;
  return packed;
}

}  // namespace

std::optional<VoxelModel> read_cached_model(LoadCache& cache, const Hash128& key,
                                            const VoxelGrid& grid, std::size_t tissues,
                                            ImportNotes* notes) {
  // What a grid's leaves take at most, all mixed and part full.
  const std::uint64_t most =
      sizeof(ModelHeader) + sizeof(double) * InputGeometry::kNumbers + kMostWarningBytes +
      std::uint64_t{grid.leaf_count()} * (2 * sizeof(std::uint32_t) + 1 + sizeof(LeafBits) +
                                          sizeof(LabelBlock) + sizeof(LeafLevels)) +
      sizeof(std::uint64_t);
  std::vector<std::byte> payload;
  const bool read = cache.read(CacheKind::kModel, key, [&](std::uint64_t bytes) {
    if (bytes <= most) payload.resize(bytes);
    return std::span(payload);
  });
  if (!read) return std::nullopt;
  ImportNotes found;
  const std::optional<PackedModel> packed = parse(payload, grid, tissues, found);
  if (!packed) {
    cache.refuse(key);
    return std::nullopt;
  }
  if (notes) *notes = std::move(found);
  return unpack(*packed);
}

void write_cached_model(LoadCache& cache, const Hash128& key, const VoxelModel& model,
                        const ImportNotes& notes) {
  const std::string warnings = text_of(notes.warnings);
  if (!cache.keeps() || warnings.size() > kMostWarningBytes) return;
  PackedModel packed = pack(model);
  std::vector<LeafBits> part_full;
  for (std::size_t row = 0; row < packed.leaves.size(); ++row) {
    if (is_full(packed.words[row])) {
      packed.leaves[row] |= kFullLeaf;
    } else {
      part_full.push_back(packed.words[row]);
    }
  }
  ModelHeader header = header_of(model.grid);
  header.flags = (model.clipped ? kClipped : 0u) | (packed.labelled ? kLabelled : 0u) |
                 (packed.filled ? kFilled : 0u);
  header.leaves = packed.leaves.size();
  header.part_full = part_full.size();
  header.mixed = packed.mixed.size();
  const auto numbers =
      notes.input ? notes.input->numbers() : std::array<double, InputGeometry::kNumbers>{};
  header.input_numbers = notes.input ? numbers.size() : 0;
  header.warning_bytes = warnings.size();
  const std::uint64_t pages = packed.levels.size();
  cache.write(CacheKind::kModel, key,
              {std::as_bytes(std::span(&header, 1)),
               std::as_bytes(std::span(numbers.data(), header.input_numbers)),
               std::as_bytes(std::span(warnings)), std::as_bytes(std::span(packed.leaves)),
               std::as_bytes(std::span(packed.mixed)), std::as_bytes(std::span(packed.leaf_labels)),
               std::as_bytes(std::span(part_full)), std::as_bytes(std::span(packed.mixed_labels)),
               std::as_bytes(std::span(&pages, packed.filled ? 1u : 0u)),
               std::as_bytes(std::span(packed.levels))});
}

}  // namespace sulcus
