#include "app/playback/ticks_csv.hpp"

#include <cstdio>
#include <memory>
#include <vector>

#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

void put(std::FILE* out, const double (&v)[3], double unit = 1.0) {
  std::fprintf(out, ",%.9g,%.9g,%.9g", v[0] / unit, v[1] / unit, v[2] / unit);
}

void put(std::FILE* out, const double (&position_m)[3], const double (&q)[4]) {
  put(out, position_m, kMillimetre);
  std::fprintf(out, ",%.9g,%.9g,%.9g,%.9g", q[0], q[1], q[2], q[3]);
}

void put(std::FILE* out, const TickRecord& r) {
  constexpr double kMillinewtonMetre = 1e-3;
  std::fprintf(out, "%llu,%.9g", static_cast<unsigned long long>(r.tick), r.time_s);
  put(out, r.tool_position_m, r.tool_orientation);
  put(out, r.force_N);
  put(out, r.torque_Nm, kMillinewtonMetre);
  std::fprintf(out, ",%u,%u,%.4g,%.4g,%llu", r.contacts, r.removed, static_cast<double>(r.step_us),
               static_cast<double>(r.late_us), static_cast<unsigned long long>(r.faults));
  put(out, r.device_position_m, r.device_orientation);
  put(out, r.contact_force_N);
}

}  // namespace

void write_ticks_csv(const std::string& file, const RecordingReader& reader,
                     const RecordedShape& shape, std::size_t rows) {
  const bool ported = reader.tables().port;
  const std::vector<PortRecord> port = ported ? reader.port(0, rows) : std::vector<PortRecord>();
  WholeFile table(file);
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(table.beside().c_str(), "w"),
                                                      std::fclose);
  if (!out) table.fail_incomplete();
  std::fputs(
      "tick,time_s,tool_x_mm,tool_y_mm,tool_z_mm,tool_qw,tool_qx,tool_qy,tool_qz,"
      "force_x_N,force_y_N,force_z_N,torque_x_mNm,torque_y_mNm,torque_z_mNm,"
      "contacts,removed,step_us,late_us,faults,"
      "device_x_mm,device_y_mm,device_z_mm,device_qw,device_qx,device_qy,device_qz,"
      "contact_force_x_N,contact_force_y_N,contact_force_z_N",
      out.get());
  if (ported) std::fputs(",asked_force_x_N,asked_force_y_N,asked_force_z_N", out.get());
  std::fputs("\n", out.get());
  for (std::size_t row = 0; row < rows; ++row) {
    put(out.get(), shape.rows()[row]);
    if (ported && row < port.size()) put(out.get(), port[row].asked_force_N);
    if (ported && row >= port.size()) std::fputs(",,,", out.get());  // of a torn end
    std::fputs("\n", out.get());
  }
  const bool failed = std::ferror(out.get()) != 0;
  if (std::fclose(out.release()) != 0 || failed) table.fail_incomplete();
  table.finish();
}

}  // namespace sulcus
