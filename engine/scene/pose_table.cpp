#include "engine/scene/pose_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kMaxLineBytes = 4096;
// Differences of what lies within these are good numbers. A clock may count since 1970.
constexpr double kFarthest_mm = 1e6, kLatest_s = 1e11, kLongest_s = 1e6;
constexpr const char* kCsvHeader = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz";
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

using Names = std::array<std::string_view, 8>;
constexpr std::array<Names, 3> kColumnNames{{
    {"t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"},
    {"time_s", "device_x_mm", "device_y_mm", "device_z_mm", "device_qw", "device_qx", "device_qy",
     "device_qz"},
    {"time_s", "tool_x_mm", "tool_y_mm", "tool_z_mm", "tool_qw", "tool_qx", "tool_qy", "tool_qz"},
}};

/// Where in a row each of the eight numbers stands, and how many fields a row has.
struct Columns {
  std::array<std::size_t, 8> of_number{};
  std::size_t count = 0;
};

std::string beginning(const std::string& line) { return "'" + line.substr(0, 80) + "'"; }

/// The fields of a line, without the blanks about them.
std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    fields.push_back(trimmed(line.substr(from, comma - from)));
    from = comma + 1;
  }
  return fields;
}

Columns columns_of(const std::string& file, const std::string& place, const std::string& line) {
  const std::vector<std::string> fields = fields_of(line);
  std::string missing;  // of the names of which the most are there
  std::size_t most = 0;
  for (const Names& names : kColumnNames) {
    Columns columns{{}, fields.size()};
    std::size_t found = 0;
    std::string lacks;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto at = std::ranges::find(fields, names[i]);
      if (at == fields.end()) {
        lacks.append(lacks.empty() ? "" : ", ").append(names[i]);
        continue;
      }
      if (std::find(at + 1, fields.end(), names[i]) != fields.end()) {
        throw InputError(file, place, std::string(names[i]) + " twice", "one column of that name");
      }
      columns.of_number[i] = static_cast<std::size_t>(at - fields.begin());
      ++found;
    }
    if (found == names.size()) return columns;
    if (found > most) {
      most = found;
      missing = lacks;
    }
  }
  throw InputError(file, place, missing.empty() ? beginning(line) : "no column " + missing,
                   kCsvHeader);
}

constexpr std::size_t kNumbers = 8;

/// The numbers of a row; none where it does not have them all.
std::optional<std::array<double, kNumbers>> numbers_of(const std::string& line,
                                                       const Columns& columns) {
  const std::vector<std::string> fields = fields_of(line);
  if (fields.size() != columns.count) return std::nullopt;
  std::array<double, kNumbers> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string& field = fields[columns.of_number[i]];
    const char* const end = field.data() + field.size();
    const auto [next, error] = std::from_chars(field.data(), end, numbers[i]);
    if (error != std::errc{} || next != end || !std::isfinite(numbers[i])) return std::nullopt;
  }
  return numbers;
}

TimedPose parse_row(const std::string& file, const std::string& place, const std::string& line,
                    const Columns& columns) {
  const auto value = numbers_of(line, columns);
  if (!value && columns.count == kNumbers) {
    throw InputError(file, place, beginning(line), std::string("8 finite numbers ") + kCsvHeader);
  }
  if (!value) {
    throw InputError(file, place, beginning(line),
                     std::to_string(columns.count) +
                         " fields, as the first line has, finite numbers among them");
  }
  const auto refuse_beyond = [&](std::size_t field, const char* name, double most) {
    if (std::abs((*value)[field]) <= most) return;
    std::ostringstream found, expected;
    found << name << " = " << (*value)[field];
    expected << -most << " to " << most;
    throw InputError(file, place, found.str(), expected.str());
  };
  refuse_beyond(0, "t_s", kLatest_s);
  refuse_beyond(1, "x_mm", kFarthest_mm);
  refuse_beyond(2, "y_mm", kFarthest_mm);
  refuse_beyond(3, "z_mm", kFarthest_mm);
  TimedPose pose;
  pose.time_s = (*value)[0];
  pose.world_from_tool.position =
      Eigen::Vector3d((*value)[1], (*value)[2], (*value)[3]) * kMillimetre;
  Eigen::Quaterniond q((*value)[4], (*value)[5], (*value)[6], (*value)[7]);
  if (std::abs(q.squaredNorm() - 1.0) > 0.02) {
    throw InputError(file, place, "a quaternion of length " + std::to_string(q.norm()),
                     "a unit quaternion qw,qx,qy,qz (1 % off at most)");
  }
  pose.world_from_tool.orientation = q.normalized();
  return pose;
}

/// Goes through the lines of a file that say something, without their ends.
class Lines {
 public:
  explicit Lines(const std::string& file) : file_(file), in_(file) {
    std::error_code error;
    if (!in_ || std::filesystem::is_directory(file, error)) {
      throw InputError(file, "", "no readable file", "a table of poses");
    }
  }

  /// False behind the last one.
  bool next() {
    while (read()) {
      const std::string text = trimmed(text_);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }
  const std::string& text() const { return text_; }
  std::string place() const { return "line " + std::to_string(number_); }

 private:
  bool read() {
    in_.getline(line_.data(), static_cast<std::streamsize>(line_.size()));
    const bool whole = in_.good() || in_.eof();
    if (in_.eof() && in_.gcount() == 0) return false;
    ++number_;
    if (!whole) {
      throw InputError(file_, place(),
                       "a line of more than " + std::to_string(kMaxLineBytes) + " bytes",
                       kCsvHeader);
    }
    text_ = std::string(line_.data(), static_cast<std::size_t>(in_.gcount()) - (in_.eof() ? 0 : 1));
    if (text_.ends_with('\r')) text_.pop_back();
    if (number_ == 1 && text_.starts_with(kByteOrderMark)) text_.erase(0, kByteOrderMark.size());
    return true;
  }

  const std::string& file_;
  std::ifstream in_;
  std::array<char, kMaxLineBytes + 1> line_{};
  std::string text_;
  std::size_t number_ = 0;
};

}  // namespace

PoseTable read_pose_table(const std::string& file, const InputLimits& limits) {
  Lines lines(file);
  if (!lines.next()) throw InputError(file, "line 1", "''", kCsvHeader);
  const Columns columns = columns_of(file, lines.place(), lines.text());
  PoseTable table;
  std::vector<TimedPose>& poses = table.poses;
  while (lines.next()) {
    TimedPose pose = parse_row(file, lines.place(), lines.text(), columns);
    if (!poses.empty() && pose.time_s <= poses.back().time_s) {
      throw InputError(file, lines.place(), "t_s = " + std::to_string(pose.time_s),
                       "times that rise");
    }
    if (!poses.empty() && pose.time_s - poses.front().time_s > kLongest_s) {
      throw InputError(
          file, lines.place(),
          "a pose " + std::to_string(pose.time_s - poses.front().time_s) + " s after the first",
          "at most 1000000 s");
    }
    if (poses.size() == limits.poses()) {
      throw InputError(file, lines.place(), "more rows",
                       "at most " + std::to_string(limits.poses()) + " (--limit-gib)");
    }
    poses.push_back(pose);
  }
  if (poses.empty()) throw InputError(file, "", "no poses", "at least one row");
  table.clock_at_start_s = poses.front().time_s;  // a recording's clock need not start at 0
  for (TimedPose& pose : poses) pose.time_s -= table.clock_at_start_s;
  return table;
}

}  // namespace sulcus
