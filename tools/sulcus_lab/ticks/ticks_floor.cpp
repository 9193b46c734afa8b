#include "tools/sulcus_lab/ticks/ticks_floor.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <vector>

#include "engine/core/realtime.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "tools/sulcus_lab/ticks/ticks_run.hpp"

namespace sulcus::lab {

namespace {

constexpr int kFloorNeighbourhood = 6, kTrace = 12;
/// Of a contact, less what only a coupling turns to. A block's stays in the caches.
constexpr std::size_t kRecordBytes = Contacts::kBytesEach - 3 * sizeof(float);

/// Place in three axes of less than 2^20 each, and one more number.
std::uint64_t key(std::int64_t a, std::int64_t b, std::int64_t c, std::uint64_t tag = 0) {
  constexpr std::int64_t kShift = 64;  // below 0: the columns' border
  return static_cast<std::uint64_t>(a + kShift) | static_cast<std::uint64_t>(b + kShift) << 20 |
         static_cast<std::uint64_t>(c + kShift) << 40 | tag << 60;
}

void add_columns(const Contact& contact, std::unordered_set<std::uint64_t>& words) {
  int axis = 0;
  contact.normal.cwiseAbs().maxCoeff(&axis);
  const Cell& c = contact.cell;
  const int u = c[(axis + 1) % 3], v = c[(axis + 2) % 3];
  // Columns are cut into words of 32 voxels; where the cuts lie hardly changes how many there are.
  const int lowest = (c[axis] - kTrace + 64) >> 5, highest = (c[axis] + kTrace + 64) >> 5;
  for (int j = v - kFloorNeighbourhood; j <= v + kFloorNeighbourhood; ++j) {
    for (int i = u - kFloorNeighbourhood; i <= u + kFloorNeighbourhood; ++i) {
      for (int word = lowest; word <= highest; ++word) {
        words.insert(key(i, j, word, static_cast<std::uint64_t>(axis)));
      }
    }
  }
}

void add_corners(const DistanceField& field, const Pose& pose, const Eigen::Vector3d& centre_world,
                 std::unordered_set<std::uint64_t>& samples) {
  const Eigen::Vector3d p = field.field_from_tool(pose.inverse_point(centre_world));
  const Eigen::Vector3i low = p.array().floor().cast<int>();
  for (int corner = 0; corner < 8; ++corner) {
    samples.insert(
        key(low.x() + (corner & 1), low.y() + (corner >> 1 & 1), low.z() + (corner >> 2)));
  }
}

/// Adds up the words, in lanes so that the sums do not wait for each other.
std::uint64_t sum_of(const std::vector<std::uint64_t>& words) {
  std::uint64_t lanes[16]{};
  for (std::size_t w = 0; w + 16 <= words.size(); w += 16) {
    for (std::size_t l = 0; l < 16; ++l) lanes[l] += words[w + l];
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t lane : lanes) sum += lane;
  return sum;
}

}  // namespace

TickFloor tick_floor(const Workpiece& workpiece, const TickPath& path, int wanted, bool fresh) {
  const HapticsSettings settings = counting_settings(wanted);
  ContactScratch scratch(settings);
  const std::vector<TissueSettings> tissues = tick_tissues(1.0);
  const Pose& pose = path.poses.front();
  evaluate_contact(workpiece, {path.burr, pose, tissues, settings}, scratch);

  std::unordered_set<std::uint64_t> leaves, samples, words;
  std::size_t contacts = 0;
  for (const Contact contact : scratch.contacts) {
    if (contact.weight <= 0.0f) continue;
    ++contacts;
    leaves.insert(workpiece.grid().leaf_of(contact.cell));
    add_corners(path.burr.field, pose, workpiece.grid().centre_world(contact.cell), samples);
    if (fresh) add_columns(contact, words);
  }
  TickFloor floor;
  floor.surface = static_cast<double>(leaves.size() * sizeof(LeafBits));
  floor.field = static_cast<double>(samples.size() * sizeof(float));
  floor.columns = static_cast<double>(words.size() * sizeof(std::uint32_t));
  floor.kept = fresh ? 0.0 : static_cast<double>(contacts * 4 * sizeof(float));
  floor.records = static_cast<double>(contacts * kRecordBytes);
  floor.gb_per_s = read_gb_per_s(static_cast<std::size_t>(floor.bytes()));
  floor.us = 1e-3 * floor.bytes() / floor.gb_per_s;
  return floor;
}

double read_gb_per_s(std::size_t bytes) {
  constexpr std::size_t kBytesPerPass = 1 << 24;
  constexpr int kPasses = 7;
  const std::vector<std::uint64_t> words(std::max<std::size_t>(128, bytes / 8 / 16 * 16), 1);
  const std::size_t rounds = std::max<std::size_t>(1, kBytesPerPass / (8 * words.size()));
  double best_ns = std::numeric_limits<double>::infinity();
  volatile std::uint64_t seen = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::uint64_t begin = thread_cpu_ns();
    for (std::size_t round = 0; round < rounds; ++round) seen = seen + sum_of(words);
    best_ns = std::min(best_ns, static_cast<double>(thread_cpu_ns() - begin));
  }
  return static_cast<double>(8 * words.size() * rounds) / best_ns;
}

}  // namespace sulcus::lab
