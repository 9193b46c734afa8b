#include "app/stream/stream_messages.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include <Eigen/Geometry>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTransformMessage.h>
#include <igtl_unit.h>

#include "app/stream/message_time.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kMostValues = 255;  // of a SENSOR

/// By the library's function in C: its class igtl::Unit packs one unit only.
igtl_unit unit(int prefix, std::initializer_list<std::pair<int, int>> powers) {
  igtl_unit_data data;
  igtl_unit_init(&data);
  data.prefix = static_cast<igtl_uint8>(prefix);
  std::size_t place = 0;
  for (const auto& [base, exponent] : powers) {
    data.unit[place] = static_cast<igtl_uint8>(base);
    data.exp[place++] = static_cast<igtl_int8>(exponent);
  }
  return igtl_unit_pack(&data);
}

void append(igtl::MessageBase& message, std::vector<std::byte>& bytes) {
  message.Pack();
  const auto* begin = static_cast<const std::byte*>(message.GetPackPointer());
  bytes.insert(bytes.end(), begin, begin + message.GetPackSize());
}

}  // namespace

struct StreamMessages::Packed {
  igtl::TransformMessage::Pointer transform = igtl::TransformMessage::New();
  igtl::SensorMessage::Pointer sensor = igtl::SensorMessage::New();
  igtl::StatusMessage::Pointer status = igtl::StatusMessage::New();
  const igtl_unit none = unit(IGTL_UNIT_PREFIX_NONE, {});
  const igtl_unit newton = unit(IGTL_UNIT_PREFIX_NONE, {{IGTL_UNIT_SI_DERIVED_NEWTON, 1}});
  const igtl_unit newton_millimetre = unit(
      IGTL_UNIT_PREFIX_MILLI, {{IGTL_UNIT_SI_DERIVED_NEWTON, 1}, {IGTL_UNIT_SI_BASE_METER, 1}});
  const igtl_unit radian_per_second = unit(
      IGTL_UNIT_PREFIX_NONE, {{IGTL_UNIT_SI_DERIVED_RADIAN, 1}, {IGTL_UNIT_SI_BASE_SECOND, -1}});
  // Without a prefix: whether that of m^3 would be raised to the third power is not said anywhere.
  const igtl_unit cubic_metre = unit(IGTL_UNIT_PREFIX_NONE, {{IGTL_UNIT_SI_BASE_METER, 3}});
  MessageTime time;  // of the tick in hand
  std::vector<std::byte> bytes;
};

StreamMessages::StreamMessages(StreamSettings names)
    : names_(std::move(names)), packed_(std::make_unique<Packed>()) {}
StreamMessages::~StreamMessages() = default;

void StreamMessages::add_sensor(const std::string& name, std::span<const double> values,
                                std::uint64_t unit_code) {
  if (name.empty()) return;
  igtl::SensorMessage& sensor = *packed_->sensor;
  sensor.SetDeviceName(name.c_str());
  sensor.SetTimeStamp(packed_->time.seconds, packed_->time.fraction);
  sensor.SetUnit(igtl::igtlUnit{unit_code});
  const std::size_t size = std::min(values.size(), kMostValues);
  sensor.SetLength(static_cast<unsigned>(size));
  for (std::size_t i = 0; i < size; ++i) sensor.SetValue(static_cast<unsigned>(i), values[i]);
  append(sensor, packed_->bytes);
}

void StreamMessages::add_pose(const std::string& name, const double (&position_m)[3],
                              const double (&orientation)[4]) {
  if (name.empty()) return;
  const Eigen::Quaterniond q(orientation[0], orientation[1], orientation[2], orientation[3]);
  const Eigen::Matrix3f rotation = q.toRotationMatrix().cast<float>();
  igtl::Matrix4x4 matrix = {};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[row][column] = rotation(row, column);
    matrix[row][3] = static_cast<float>(position_m[row] * 1e3);
  }
  matrix[3][3] = 1.0f;
  igtl::TransformMessage& transform = *packed_->transform;
  transform.SetDeviceName(name.c_str());
  transform.SetTimeStamp(packed_->time.seconds, packed_->time.fraction);
  transform.SetMatrix(matrix);
  append(transform, packed_->bytes);
}

StreamBytes StreamMessages::sample(const StreamSample& sample) {
  const TickRecord& tick = sample.tick;
  Packed& packed = *packed_;
  packed.time = message_time(tick.time_s);
  packed.bytes.clear();
  add_sensor(names_.tick,
             std::array{static_cast<double>(tick.tick), static_cast<double>(tick.contacts),
                        static_cast<double>(tick.faults)},
             packed.none);
  add_pose(names_.tool, tick.tool_position_m, tick.tool_orientation);
  if (sample.hand) add_pose(names_.hand, tick.device_position_m, tick.device_orientation);
  std::array<double, 6> wrench;
  std::ranges::copy(tick.force_N, wrench.begin());
  std::ranges::copy(tick.contact_force_N, wrench.begin() + 3);
  add_sensor(names_.force, wrench, packed.newton);
  const auto in_newton_millimetres = [](double torque_Nm) { return torque_Nm * 1e3; };
  std::ranges::transform(tick.torque_Nm, wrench.begin(), in_newton_millimetres);
  std::ranges::transform(tick.contact_torque_Nm, wrench.begin() + 3, in_newton_millimetres);
  add_sensor(names_.torque, wrench, packed.newton_millimetre);
  if (sample.cutting) {
    add_sensor(names_.speed, std::array{sample.cutting->spindle_rad_per_s},
               packed.radian_per_second);
    add_sensor(names_.removed, sample.removed_m3, packed.cubic_metre);
  }
  return std::make_shared<const std::vector<std::byte>>(packed.bytes);
}

StreamBytes StreamMessages::state(StreamState state, std::uint64_t tick, double time_s,
                                  const std::string& text) {
  if (names_.state.empty()) return nullptr;
  using Status = igtl::StatusMessage;
  constexpr std::array kCodes{Status::STATUS_OK, Status::STATUS_OK, Status::STATUS_UNKNOWN_ERROR,
                              Status::STATUS_SHUT_DOWN};
  Status& status = *packed_->status;
  const MessageTime time = message_time(time_s);
  status.SetDeviceName(names_.state.c_str());
  status.SetTimeStamp(time.seconds, time.fraction);
  status.SetCode(kCodes[static_cast<std::size_t>(state)]);
  status.SetSubCode(static_cast<igtlInt64>(tick));
  status.SetErrorName(std::string(name_of(state)).c_str());
  status.SetStatusString(text.c_str());
  std::vector<std::byte> bytes;
  append(status, bytes);
  return std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

std::string_view name_of(StreamState state) {
  constexpr std::array<std::string_view, 4> kNames{"running", "paused", "fault", "over"};
  return kNames[static_cast<std::size_t>(state)];
}

}  // namespace sulcus
