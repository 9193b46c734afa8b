/* A haptic device and the hand on it, simulated: the example to start a plug-in from. It does what
 * `[device] model = "simulated"` does with its preset "omni" and the hand "light", so that the two
 * can be compared (tests/pipeline/plugin_test.cpp).
 *
 *   (m + m_h) x'' + (b + b_h) x' + k_h (x - x_hand) - b_h x_hand' + friction = push + force
 *
 * x is the handle, the point `reference_m` up the tool's axis from the tip; x_hand goes along the
 * scene's trajectory. The handle cannot be turned: its direction is the trajectory's. Integrated by
 * the implicit midpoint rule, as haptics/device/simulated_device.cpp derives it.
 *
 * settings = "push_N=1": from the first force that it feels, or a faint one that lasts 0.1 s, the
 * hand pushes down with so much more, which comes within 0.2 s. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sulcus_device.h"

/* The device. */
static const double kMass_kg = 0.045, kDamping_N_s_per_m = 0.1, kFriction_N = 0.05;
static const double kResolution_m = 55e-6;
/* The hand. */
static const double kHandDamping_N_s_per_m = 2.0, kHandStiffness_N_per_m = 100.0;
static const double kPushRamp_s = 0.2, kLargestPush_N = 20.0;
static const double kFelt_N = 0.01, kFaint_N = 1e-3, kLasting_s = 0.1;
static const double kSubstep_s = 25e-6; /* at most */

typedef struct Device {
  const SulcusDeviceHost* host;
  double push_N;
  double position_m[3], velocity_m_per_s[3]; /* of the handle */
  double held_N[3];                          /* the force until the next one */
  int pushes, felt_ticks;
  uint64_t tick, pushes_since;
} Device;

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* The tool's +y in world axes: the second column of the rotation that (w, x, y, z) is. */
static void axis_of(const SulcusPose* pose, double axis[3]) {
  const double* q = pose->orientation;
  axis[0] = 2.0 * (q[1] * q[2] - q[0] * q[3]);
  axis[1] = 1.0 - 2.0 * (q[1] * q[1] + q[3] * q[3]);
  axis[2] = 2.0 * (q[2] * q[3] + q[0] * q[1]);
}

/* Where the hand wants the handle at a tick, and the pose of the tip that goes with it. */
static SulcusPose hand_at(const Device* device, uint64_t tick, double handle_m[3]) {
  const SulcusDeviceHost* host = device->host;
  SulcusPose tip;
  double axis[3];
  host->trajectory(host, (double)tick / host->rate_hz, &tip);
  axis_of(&tip, axis);
  for (int i = 0; i < 3; ++i) handle_m[i] = tip.position_m[i] + host->reference_m * axis[i];
  return tip;
}

/* `text` is "" or "push_N=NUMBER". */
static int read_settings(const char* text, double* push_N) {
  static const char kKey[] = "push_N=";
  *push_N = 0.0;
  if (*text == '\0') return 1;
  if (strncmp(text, kKey, sizeof(kKey) - 1) != 0) return 0;
  const char* number = text + sizeof(kKey) - 1;
  char* end = NULL;
  *push_N = strtod(number, &end);
  return end != number && *end == '\0' && *push_N >= 0.0 && *push_N <= kLargestPush_N;
}

static int open_device(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** opened,
                       char* message, size_t message_size) {
  double push_N;
  if (!read_settings(host->settings, &push_N)) {
    snprintf(message, message_size, "settings '%.60s', expected push_N=NUMBER, 0 to %g",
             host->settings, kLargestPush_N);
    return SULCUS_DEVICE_GONE;
  }
  Device* device = calloc(1, sizeof(Device));
  if (!device) {
    snprintf(message, message_size, "no memory");
    return SULCUS_DEVICE_GONE;
  }
  device->host = host;
  device->push_N = push_N;
  hand_at(device, 0, device->position_m);
  limits->force_N = 3.3;
  limits->torque_Nm = 0.0;
  limits->stiffness_N_per_m = 700.0;
  limits->resolution_m = kResolution_m;
  *opened = device;
  return SULCUS_DEVICE_OK;
}

/* Velocity after a substep h, and the handle moved by it. `gap`, `hand_velocity`: from the handle
 * to the far end of the hand's spring at the substep's start, and how fast that goes. */
static void substep(Device* device, const double gap[3], const double hand_velocity[3],
                    double push_N, double h) {
  const double per_mean =
      0.5 * (kDamping_N_s_per_m + kHandDamping_N_s_per_m) + 0.25 * h * kHandStiffness_N_per_m;
  const double resisting = kMass_kg / h + per_mean;
  double next[3];
  for (int i = 0; i < 3; ++i) {
    const double driving = device->held_N[i] - (i == 2 ? push_N : 0.0) +
                           kHandStiffness_N_per_m * (gap[i] + 0.5 * h * hand_velocity[i]) +
                           kHandDamping_N_s_per_m * hand_velocity[i];
    next[i] = ((kMass_kg / h - per_mean) * device->velocity_m_per_s[i] + driving) / resisting;
  }
  /* Friction takes speed away, whatever the direction, and no more than there is. */
  const double speed = length(next), taken = kFriction_N / resisting;
  const double left = speed <= taken ? 0.0 : 1.0 - taken / speed;
  for (int i = 0; i < 3; ++i) {
    const double velocity = left * next[i];
    device->position_m[i] += 0.5 * h * (device->velocity_m_per_s[i] + velocity);
    device->velocity_m_per_s[i] = velocity;
  }
}

/* The hand's push within the tick before `tick`, `part` of it gone. */
static double push_at(const Device* device, uint64_t tick, double part) {
  if (!device->pushes) return 0.0;
  const double pushing_s =
      ((double)(tick - 1 - device->pushes_since) + part) / device->host->rate_hz;
  return pushing_s < kPushRamp_s ? device->push_N * pushing_s / kPushRamp_s : device->push_N;
}

/* From the tick before to this one. */
static void advance(Device* device, uint64_t tick) {
  const double dt_s = 1.0 / device->host->rate_hz;
  const int substeps = 1 + (int)(dt_s / kSubstep_s - 1e-6);
  double from[3], to[3];
  hand_at(device, tick - 1, from);
  hand_at(device, tick, to);
  for (int n = 0; n < substeps; ++n) {
    double gap[3], hand_velocity[3];
    for (int i = 0; i < 3; ++i) {
      gap[i] = from[i] + (double)n / substeps * (to[i] - from[i]) - device->position_m[i];
      hand_velocity[i] = (to[i] - from[i]) / dt_s;
    }
    substep(device, gap, hand_velocity, push_at(device, tick, (n + 0.5) / substeps),
            dt_s / substeps);
  }
}

static int read_pose(void* opened, uint64_t tick, SulcusPose* pose) {
  Device* device = opened;
  double hand_m[3], axis[3];
  if (tick > 0) advance(device, tick);
  device->tick = tick;
  *pose = hand_at(device, tick, hand_m);
  axis_of(pose, axis);
  for (int i = 0; i < 3; ++i) {
    const double encoder = floor(device->position_m[i] / kResolution_m + 0.5) * kResolution_m;
    pose->position_m[i] = encoder - device->host->reference_m * axis[i];
  }
  return SULCUS_DEVICE_OK;
}

static int write_wrench(void* opened, uint64_t tick, const SulcusWrench* wrench, int last) {
  Device* device = opened;
  (void)last;
  memcpy(device->held_N, wrench->force_N, sizeof(device->held_N));
  if (device->pushes) return SULCUS_DEVICE_OK;
  const double felt_N = length(device->held_N);
  device->felt_ticks = felt_N > kFaint_N ? device->felt_ticks + 1 : 0;
  if (felt_N > kFelt_N || device->felt_ticks / device->host->rate_hz > kLasting_s) {
    device->pushes = 1;
    device->pushes_since = tick;
  }
  return SULCUS_DEVICE_OK;
}

static void no_message(void* opened, char* message, size_t message_size) {
  (void)opened;
  if (message_size > 0) message[0] = '\0';
}

static void close_device(void* opened) { free(opened); }

const SulcusDevicePlugin* sulcus_device_plugin(void) {
  static const SulcusDevicePlugin plugin = {
      .version = SULCUS_DEVICE_VERSION,
      .struct_size = sizeof(SulcusDevicePlugin),
      .flags = 0, /* time is the number of ticks: any pace will do */
      .name = "simulated device 1.0",
      .open = open_device,
      .read = read_pose,
      .write = write_wrench,
      .message = no_message,
      .close = close_device,
  };
  return &plugin;
}
