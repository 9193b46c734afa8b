#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/units.hpp"
#include "engine/scene/device_presets.hpp"
#include "engine/scene/table_readers.hpp"

namespace sulcus {

namespace {

HandSettings read_hand(SceneTable& table) {
  HandSettings h = hand_preset(kHandPresetNames[table.choice("hand")]);
  h.mass_kg = table.number("hand_mass_g", h.mass_kg * 1e3) * 1e-3;
  h.damping_N_s_per_m = table.number("hand_damping_N_s_per_m", h.damping_N_s_per_m);
  h.stiffness_N_per_m = table.number("hand_stiffness_N_per_m", h.stiffness_N_per_m);
  h.turning_damping_Nm_s_per_rad =
      table.number("hand_turning_damping_mNm_s_per_rad", h.turning_damping_Nm_s_per_rad * 1e3) *
      1e-3;
  h.turning_stiffness_Nm_per_rad =
      table.number("hand_turning_stiffness_mNm_per_rad", h.turning_stiffness_Nm_per_rad * 1e3) *
      1e-3;
  h.push_N = table.number("push_N");
  h.push_ramp_s = table.number("push_ramp_s");
  h.push_direction = table.direction("push_direction");
  return h;
}

/// The number of the tick at a time.
std::uint64_t tick_at(double time_s, double rate_hz) {
  return static_cast<std::uint64_t>(std::llround(time_s * rate_hz));
}

void read_faults(SceneTable& table, double rate_hz, DeviceSettings& d) {
  for (const auto& row : table.rows("late_s")) {
    d.late.push_back({tick_at(row[0], rate_hz), row[1]});
  }
  for (const auto& row : table.rows("silent_s")) {
    if (row[1] < row[0]) table.fail("silent_s", "an end before its beginning", "[from_s, to_s]");
    d.silences.push_back({tick_at(row[0], rate_hz), tick_at(row[1], rate_hz)});
  }
  for (const auto& row : table.rows("jump_s_mm")) {
    if (row[0] < 0.0) table.fail("jump_s_mm", "a time before the start", "0 s or later");
    d.jumps.push_back(
        {tick_at(row[0], rate_hz), kMillimetre * Eigen::Vector3d(row[1], row[2], row[3])});
  }
}

/// What may stand in a plug-in's name: no path fits.
bool is_plugin_name(std::string_view name) {
  constexpr std::size_t kLongest = 64;
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

/// Until the plug-in is there to say more, the limits are those of a common device.
DeviceSettings read_plugin(SceneTable& table, std::string name) {
  PluginSettings plugin;
  plugin.name = std::move(name);
  if (!is_plugin_name(plugin.name)) {
    table.fail("plugin", "'" + plugin.name + "'",
               "the name of a plug-in, of letters, digits, _ and -, and never a path");
  }
  plugin.settings = table.text("settings", "");
  plugin.placement.position_m = table.vector3("position_mm") * kMillimetre;
  plugin.placement.rotation = table.vector3("rotation_deg") * kDegree;
  plugin.placement.scale = table.number("scale");
  plugin.placement.recentre = table.boolean("recentre");
  if (plugin.placement.recentre && table.has("position_mm")) {
    table.fail("recentre", "both recentre and a position_mm", "one of them");
  }
  plugin.force_limit_N = table.number_if("force_limit_N");
  plugin.torque_limit_Nm = table.number_if("torque_limit_mNm");
  if (plugin.torque_limit_Nm) *plugin.torque_limit_Nm *= 1e-3;
  plugin.stiffness_N_per_m = table.number_if("stiffness_N_per_mm");
  if (plugin.stiffness_N_per_m) *plugin.stiffness_N_per_m *= kNewtonPerMillimetre;
  plugin.resolution_m = table.number_if("resolution_mm");
  if (plugin.resolution_m) *plugin.resolution_m *= kMillimetre;
  DeviceSettings d = device_preset("omni");
  d.force_limit_N = plugin.force_limit_N.value_or(d.force_limit_N);
  d.torque_limit_Nm = plugin.torque_limit_Nm.value_or(d.torque_limit_Nm);
  d.stiffness_N_per_m = plugin.stiffness_N_per_m.value_or(d.stiffness_N_per_m);
  d.resolution_m = plugin.resolution_m.value_or(d.resolution_m);
  d.delay_ticks = table.whole("delay_ticks");
  d.passivity_controller = table.boolean("passivity_controller");
  d.plugin = std::move(plugin);
  table.finish();
  return d;
}

}  // namespace

DeviceSettings read_device(SceneTable& table, double rate_hz) {
  const auto model = table.choice_if("model");
  if (model.has_value() == table.has("plugin")) {
    table.fail("model", model ? "both a model and a plugin" : "none",
               "\"simulated\" or \"played_back\", or plugin = \"NAME\"");
  }
  if (!model) return read_plugin(table, table.text("plugin", ""));
  DeviceSettings d = device_preset(kDevicePresetNames[table.choice("preset")]);
  d.played_back = *model == 1;
  d.hand = read_hand(table);
  d.force_limit_N = table.number("force_limit_N", d.force_limit_N);
  d.torque_limit_Nm = table.number("torque_limit_mNm", d.torque_limit_Nm * 1e3) * 1e-3;
  d.mass_kg = table.number("mass_g", d.mass_kg * 1e3) * 1e-3;
  d.damping_N_s_per_m = table.number("damping_N_s_per_m", d.damping_N_s_per_m);
  d.friction_N = table.number("friction_N", d.friction_N);
  d.resolution_m = table.number("resolution_mm", d.resolution_m / kMillimetre) * kMillimetre;
  d.delay_ticks = table.whole("delay_ticks");
  d.passivity_controller = table.boolean("passivity_controller");
  read_faults(table, rate_hz, d);
  table.finish();
  return d;
}

CouplingSettings read_coupling(SceneTable& table, const std::optional<DeviceSettings>& device) {
  CouplingSettings c;
  if (device) {
    c.stiffness_N_per_m = device->stiffness_N_per_m;
    c.force_limit_N = device->force_limit_N;
    if (device->torque_limit_Nm > 0.0) c.torque_limit_Nm = device->torque_limit_Nm;
  }
  c.stiffness_N_per_m =
      table.number("stiffness_N_per_mm", c.stiffness_N_per_m / kNewtonPerMillimetre) *
      kNewtonPerMillimetre;
  c.turning_stiffness_Nm_per_rad = table.number("turning_stiffness_Nm_per_rad");
  c.force_limit_N = table.number("force_limit_N", c.force_limit_N);
  c.torque_limit_Nm = table.number("torque_limit_mNm", c.torque_limit_Nm * 1e3) * 1e-3;
  c.evaluations = table.whole("evaluations");
  c.contacts_per_tick = table.whole("contacts_per_tick");
  table.finish();
  return c;
}

}  // namespace sulcus
