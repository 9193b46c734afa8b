#pragma once

#include <array>
#include <cstdint>

namespace sulcus {

/// The stages of a tick: one name in file, function, timer and chart.
enum class Stage : std::uint8_t { kBroadPhase, kNarrowPhase, kNormals, kContactForce, kRemoval };
inline constexpr int kStageCount = 5;
inline constexpr std::array<const char*, kStageCount> kStageNames{
    "broad_phase", "narrow_phase", "normals", "contact_force", "removal"};

/// Adds up the time of each stage of a tick. The tick itself has no clock: its caller hands one in,
/// and no result depends on it. Without one nothing is measured.
class StageClock {
 public:
  using Now = std::uint64_t (*)() noexcept;  // nanoseconds of any steady clock

  explicit StageClock(Now now = nullptr) : now_(now) {}
  void reset() noexcept { ns_ = {}; }
  std::uint64_t ns(Stage stage) const noexcept { return ns_[static_cast<int>(stage)]; }

  /// Times one block: `const auto timed = clock.time(Stage::kNormals);`
  class Timed {
   public:
    Timed(StageClock& clock, Stage stage) noexcept
        : clock_(clock), stage_(stage), begin_(clock.now_ ? clock.now_() : 0) {}
    ~Timed() {
      if (clock_.now_) clock_.ns_[static_cast<int>(stage_)] += clock_.now_() - begin_;
    }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;

   private:
    StageClock& clock_;
    Stage stage_;
    std::uint64_t begin_;
  };
  [[nodiscard]] Timed time(Stage stage) noexcept { return {*this, stage}; }

 private:
  Now now_;
  std::array<std::uint64_t, kStageCount> ns_{};
};

}  // namespace sulcus
