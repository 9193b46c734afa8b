/* Plug-ins that cannot be used, one for each definition. */
#ifdef SULCUS_data_entry
/* Its entry is no function. */
__attribute__((visibility("default"))) int sulcus_device_plugin = 1;
#else
#include "sulcus_device.h"

#ifdef SULCUS_no_entry
/* A library, but no plug-in. */
__attribute__((visibility("default"))) int not_the_entry(void);
int not_the_entry(void) { return 0; }
#else

static int open_device(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** opened,
                       char* message, size_t message_size) {
  (void)host, (void)limits, (void)opened, (void)message, (void)message_size;
  return SULCUS_DEVICE_GONE;
}
static int write_wrench(void* opened, uint64_t tick, const SulcusWrench* wrench, int last) {
  (void)opened, (void)tick, (void)wrench, (void)last;
  return SULCUS_DEVICE_OK;
}
static void say(void* opened, char* message, size_t message_size) {
  (void)opened, (void)message, (void)message_size;
}
static void close_device(void* opened) { (void)opened; }

const SulcusDevicePlugin* sulcus_device_plugin(void) {
  static const SulcusDevicePlugin plugin = {
#ifdef SULCUS_other_version
      .version = SULCUS_DEVICE_VERSION + 1,
#else
      .version = SULCUS_DEVICE_VERSION,
#endif
      .struct_size = sizeof(SulcusDevicePlugin),
      .name = "unusable",
      .open = open_device,
      .read = 0,
      .write = write_wrench,
      .message = say,
      .close = close_device,
  };
  return &plugin;
}

#endif
#endif
