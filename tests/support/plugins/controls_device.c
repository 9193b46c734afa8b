/* A device that follows the scene's trajectory and does with pedal, clutch and burr what its
 * settings say: "TICK WHAT VALUE TICK WHAT VALUE ...", WHAT being pedal, clutch, burr or over, each
 * from that tick on. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sulcus_device.h"

enum { kMost = 32 };

typedef struct Step {
  unsigned long long tick;
  char what[16];
  double value;
} Step;

typedef struct Device {
  const SulcusDeviceHost* host;
  Step steps[kMost];
  int count;
} Device;

static int open_device(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** opened,
                       char* message, size_t message_size) {
  Device* device = calloc(1, sizeof(Device));
  if (!device) return SULCUS_DEVICE_GONE;
  device->host = host;
  int used = 0;
  for (const char* text = host->settings; device->count < kMost; text += used, ++device->count) {
    Step* step = &device->steps[device->count];
    if (sscanf(text, "%llu %15s %lf%n", &step->tick, step->what, &step->value, &used) != 3) break;
  }
  if (device->count == 0) {
    snprintf(message, message_size, "settings that say nothing");
    free(device);
    return SULCUS_DEVICE_GONE;
  }
  limits->force_N = 3.3;
  limits->torque_Nm = 0.1;
  limits->stiffness_N_per_m = 700.0;
  limits->resolution_m = 0.0;
  *opened = device;
  return SULCUS_DEVICE_OK;
}

/* What the last step of a kind up to a tick says. */
static double value(const Device* device, unsigned long long tick, const char* what,
                    double otherwise) {
  for (int i = 0; i < device->count; ++i) {
    const Step* step = &device->steps[i];
    if (step->tick <= tick && strcmp(step->what, what) == 0) otherwise = step->value;
  }
  return otherwise;
}

static int read_pose(void* opened, uint64_t tick, SulcusPose* pose) {
  const Device* device = opened;
  if (value(device, tick, "over", 0.0) > 0.0) return SULCUS_DEVICE_OVER;
  device->host->trajectory(device->host, (double)tick / device->host->rate_hz, pose);
  return SULCUS_DEVICE_OK;
}

static void read_controls(void* opened, uint64_t tick, SulcusControls* controls) {
  const Device* device = opened;
  controls->pedal = value(device, tick, "pedal", controls->pedal);
  controls->clutch = value(device, tick, "clutch", 0.0) > 0.0;
  controls->burr = (uint32_t)value(device, tick, "burr", (double)controls->burr);
}

static int write_wrench(void* opened, uint64_t tick, const SulcusWrench* wrench, int last) {
  (void)opened, (void)tick, (void)wrench, (void)last;
  return SULCUS_DEVICE_OK;
}
static void say(void* opened, char* message, size_t message_size) {
  (void)opened, (void)message, (void)message_size;
}
static void close_device(void* opened) { free(opened); }

const SulcusDevicePlugin* sulcus_device_plugin(void) {
  static const SulcusDevicePlugin plugin = {
      .version = SULCUS_DEVICE_VERSION,
      .struct_size = sizeof(SulcusDevicePlugin),
      .name = "pedal, clutch and burr of a test",
      .open = open_device,
      .read = read_pose,
      .write = write_wrench,
      .message = say,
      .close = close_device,
      .controls = read_controls,
  };
  return &plugin;
}
