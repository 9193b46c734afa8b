/* A device that follows the scene's trajectory until it has a fault.
 *
 * settings = "FAULT TICK FILE": what, from which tick on, and where it writes, when it is closed,
 * what it was sent: "writes N largest_N X last_N Y last L step_N S torque_step_Nm T falling F", F
 * the writes on end, up to the last, each of which was less than the one before. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sulcus_device.h"

typedef struct Device {
  const SulcusDeviceHost* host;
  char fault[32], file[256];
  unsigned long long from;
  unsigned long long writes;
  double largest_N, last_N;
  SulcusWrench before;
  double step_N, torque_step_Nm; /* the largest */
  unsigned long long falling;
  int last;
} Device;

static int is(const Device* device, const char* fault) { return !strcmp(device->fault, fault); }

static int open_device(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** opened,
                       char* message, size_t message_size) {
  Device* device = calloc(1, sizeof(Device));
  if (!device) return SULCUS_DEVICE_GONE;
  device->host = host;
  sscanf(host->settings, "%31s %llu %255s", device->fault, &device->from, device->file);
  if (is(device, "no_device")) {
    snprintf(message, message_size, "no device on the bus\nand a second line");
    free(device);
    return 17;
  }
  if (is(device, "no_word")) {
    free(device);
    return 18;
  }
  limits->force_N = is(device, "bad_limits") ? NAN : 2.0;
  limits->torque_Nm = 0.05;
  limits->stiffness_N_per_m = 650.0;
  if (!is(device, "no_limits")) limits->resolution_m = 1e-5;
  *opened = device;
  return SULCUS_DEVICE_OK;
}

static int read_pose(void* opened, uint64_t tick, SulcusPose* pose) {
  const Device* device = opened;
  SulcusPose follows;
  device->host->trajectory(device->host, (double)tick / device->host->rate_hz, &follows);
  if (is(device, "inside") && tick < device->from) follows.position_m[2] = 0.0;
  const int has_come = tick >= device->from;
  if (has_come && is(device, "unset")) return SULCUS_DEVICE_OK;
  *pose = follows;
  if (!has_come) return SULCUS_DEVICE_OK;
  if (is(device, "not_finite")) pose->position_m[1] = NAN;
  if (is(device, "far")) pose->position_m[0] = 11.0;
  if (is(device, "not_unit")) pose->orientation[0] = 2.0;
  if (is(device, "jump")) pose->position_m[2] -= 8e-3;
  if (is(device, "silent") && tick < device->from + 100) return SULCUS_DEVICE_NO_POSE;
  if (is(device, "slow") && tick < device->from + 3) usleep(40000);
  if (is(device, "hang")) pause();
  if (is(device, "interrupt") && tick == device->from) kill(getpid(), SIGINT);
  if (is(device, "gone")) return SULCUS_DEVICE_GONE;
  if (is(device, "odd_code")) return -5;
  return SULCUS_DEVICE_OK;
}

static double distance(const double* a, const double* b) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static int write_wrench(void* opened, uint64_t tick, const SulcusWrench* wrench, int last) {
  Device* device = opened;
  const double* f = wrench->force_N;
  ++device->writes;
  device->step_N = fmax(device->step_N, distance(f, device->before.force_N));
  device->torque_step_Nm =
      fmax(device->torque_step_Nm, distance(wrench->torque_Nm, device->before.torque_Nm));
  device->before = *wrench;
  const double now_N = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  device->falling = now_N < device->last_N ? device->falling + 1 : 0;
  device->last_N = now_N;
  device->largest_N = fmax(device->largest_N, device->last_N);
  device->last = last;
  return is(device, "gone_at_write") && tick >= device->from ? SULCUS_DEVICE_GONE
                                                             : SULCUS_DEVICE_OK;
}

static void say(void* opened, char* message, size_t message_size) {
  const Device* device = opened;
  if (is(device, "hang_at_message")) pause();
  snprintf(message, message_size, is(device, "gone") ? "the cable came off" : "");
}

static void close_device(void* opened) {
  Device* device = opened;
  if (is(device, "hang_at_close")) pause();
  FILE* file = device->file[0] ? fopen(device->file, "w") : NULL;
  if (file) {
    fprintf(file,
            "writes %llu largest_N %.9f last_N %.9f last %d step_N %.9f torque_step_Nm %.9f "
            "falling %llu\n",
            device->writes, device->largest_N, device->last_N, device->last, device->step_N,
            device->torque_step_Nm, device->falling);
    fclose(file);
  }
  free(device);
}

const SulcusDevicePlugin* sulcus_device_plugin(void) {
  static const SulcusDevicePlugin plugin = {
      .version = SULCUS_DEVICE_VERSION,
      .struct_size = sizeof(SulcusDevicePlugin),
      .name = "faulty",
      .open = open_device,
      .read = read_pose,
      .write = write_wrench,
      .message = say,
      .close = close_device,
  };
  return &plugin;
}
