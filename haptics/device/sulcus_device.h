/* The interface between Sulcus and a haptic device: what a vendor's library implements.
 *
 * A plug-in is a shared library `sulcus_device_NAME.so` that has one symbol, SULCUS_DEVICE_ENTRY. A
 * scene names it, `[device] plugin = "NAME"`, and Sulcus looks for it in the folder of --plugins
 * and in that of the installation, and nowhere else. C11 or any language that can do as C does;
 * tools/plugins/simulated is a complete example, tools/plugins/udp another.
 *
 * Units     SI: metres, seconds, newtons, newton metres. A quaternion is (w, x, y, z), of length 1.
 * Spaces    World: the scene's. Its origin is the centre of the tooth's grid; +z is up, away from
 *           the root. Tool: its origin is the burr's tip, +y the axis towards the shank. A pose is
 *           of the tool in the world. Whoever has a workspace of its own brings it to the world,
 *           most simply so that its middle comes to SulcusDeviceHost::start; or leaves that to the
 *           scene, whose [device] position_mm, rotation_deg, scale and recentre do it here.
 * Threads   open and close are called by the main thread, read, controls and write by the haptic
 *           thread, never two of them at a time. That thread has real-time priority, where the
 * system grants it, and a millisecond for all that is to be done in a tick. In a tick read,
 * controls and write return within 50 us. They neither wait, sleep, lock what another thread may
 * hold for long, write to the terminal or a file, nor take memory. What is slow belongs to a thread
 * of the plug-in's own, which hands the newest pose over. At real pace a read that takes longer
 * than 20 ms counts as no answer; a call that does not return within 2 s ends the program. Life
 * open; seconds may pass while the tooth is loaded; then read, controls after a read that gave a
 * pose, and write in turns, once a tick, from tick 0; while the burr is changed the force falls to
 * zero and seconds may pass between two ticks; at the end, whatever ended the run, write alone,
 * once a tick, for 50 ms, in which the wrench falls to zero; write of a zero wrench, `last` set;
 * message; close. A device is to have no force before the first write and after the last, and to
 *           take the force off by itself when no write comes for 50 ms: a program may be killed.
 * Errors    Codes below; no exception leaves a plug-in. A pose with a number that is not finite, an
 *           orientation that is far from length 1 or a position beyond 10 m ends the run.
 * Forces    are finite, already limited to what `open` said, change by 0.5 N and 20 mN m a tick at
 *           most, and come and go on ramps. A plug-in checks what matters for safety all the same.
 * Versions  SULCUS_DEVICE_VERSION rises when an old plug-in or program would misunderstand a new
 *           one. Plug-ins of an older version are still loaded: of version 1 there is neither
 *           `controls` nor SULCUS_DEVICE_OVER. Those of a newer one are refused. Structures grow at
 * their ends only: `struct_size` is what the side that fills one knows of it; what lies beyond is
 * not there.
 *
 * Licence: MIT, as the rest; copy this file as you like. */
#ifndef SULCUS_DEVICE_H
#define SULCUS_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SULCUS_DEVICE_VERSION 2u
/* The symbol: `const SulcusDevicePlugin* sulcus_device_plugin(void)`. */
#define SULCUS_DEVICE_ENTRY "sulcus_device_plugin"

/* What functions return. Any other number is taken as SULCUS_DEVICE_GONE. */
enum {
  SULCUS_DEVICE_OK = 0,
  /* read: no pose in this tick. For up to 20 ms the last one stands and all goes on. After that
   * tool and spindle stand still, and the force falls to zero in 50 ms; it comes back on a ramp of
   * 0.1 s when there is a pose again. A pose more than 5 mm from the last one is a jump: in its
   * tick there is neither cutting nor friction, and the force comes on that ramp. */
  SULCUS_DEVICE_NO_POSE = 1,
  /* It failed for good, and the plug-in has taken off what force it could. Neither read nor write
   * is called again; the run ends. */
  SULCUS_DEVICE_GONE = 2,
  /* read: the user has ended it. The run comes to its end as it does by itself. Since version 2. */
  SULCUS_DEVICE_OVER = 3
};

/* Bits of SulcusDevicePlugin::flags. */
enum {
  /* The device lives in real time: a run at any other pace is refused. Without it a tick may come
   * as soon as the last is done, and time is the number of ticks. */
  SULCUS_DEVICE_REAL_TIME = 1u << 0
};

typedef struct SulcusPose {
  double position_m[3];  /* of the burr's tip, world */
  double orientation[4]; /* w, x, y, z; world from tool */
} SulcusPose;

typedef struct SulcusWrench {
  double force_N[3];   /* on the hand, world axes */
  double torque_Nm[3]; /* likewise, about SulcusDeviceHost::reference_m */
} SulcusWrench;

/* SulcusControls::burr: it is not to be changed. */
#define SULCUS_BURR_AS_IT_IS 0xFFFFFFFFu

/* What is asked for beside the pose. Before each call Sulcus sets what holds without a plug-in's
 * word: all of the speed, no clutch, the burr as it is. Since version 2. */
typedef struct SulcusControls {
  uint32_t struct_size; /* set by Sulcus */
  uint32_t burr; /* 0: the scene's [burr], n: its n-th [[spare_burr]]; the burr is changed, once the
                  * force has fallen to zero, when this changes; before the first tick it is 0 */
  double pedal;  /* of the burr's speed, 0 to 1; 0: the spindle stands */
  uint32_t clutch; /* 1: the burr stays where it is while the hand moves on; it cuts nothing, and
                    * nothing is felt */
  uint32_t reserved;
} SulcusControls;

/* What a device is opened with. It stays where it is until close. */
typedef struct SulcusDeviceHost {
  uint32_t struct_size;
  uint32_t reserved;
  double rate_hz;       /* ticks a second */
  double reference_m;   /* torques are about the point this far up the tool's axis */
  SulcusPose start;     /* where the scene's trajectory starts, outside of the tooth */
  const char* settings; /* [device] settings of the scene, UTF-8; "" where there are none. A
                         * stranger may have written the scene: check them. */
  /* Where the scene's trajectory is at a time from 0 on; at its end it stays. For devices that are
   * simulated and those that guide a hand. May be called in read and write. */
  void (*trajectory)(const struct SulcusDeviceHost* host, double time_s, SulcusPose* pose);
} SulcusDeviceHost;

/* What open says of the device. A scene may ask for less, never for more. */
typedef struct SulcusDeviceLimits {
  uint32_t struct_size; /* set by Sulcus */
  uint32_t reserved;
  double force_N;           /* magnitude, 0.001 to 1000 */
  double torque_Nm;         /* magnitude, 0 to 100; 0: it renders none */
  double stiffness_N_per_m; /* the largest its maker recommends, 1 to 1e6 */
  double resolution_m;      /* of a position as it is read, 0 to 0.01; 0: unknown */
} SulcusDeviceLimits;

typedef struct SulcusDevicePlugin {
  uint32_t version;     /* SULCUS_DEVICE_VERSION */
  uint32_t struct_size; /* sizeof(SulcusDevicePlugin) */
  uint32_t flags;
  uint32_t reserved;
  const char* name; /* of device and plug-in, with its version, for the log; one line */

  /* Opens the device and fills all of `limits`. `*device` is handed to all that follows. On
   * failure: a code other than OK, why in `message`, one line of at most `message_size` bytes with
   * its closing 0, and nothing left open: close is not called. */
  int (*open)(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** device,
              char* message, size_t message_size);

  /* The pose at the start of a tick. `tick` rises by one from call to call. */
  int (*read)(void* device, uint64_t tick, SulcusPose* pose);

  /* The wrench of that tick, or of a step of the fall at the end. `last`: it is zero, and no more
   * come. */
  int (*write)(void* device, uint64_t tick, const SulcusWrench* wrench, int last);

  /* Before close, where the run came to its end: what the user is to know of how it went or why the
   * device is gone, one line of at most `message_size` bytes with its closing 0; left empty,
   * nothing is said. By the main thread.
   */
  void (*message)(void* device, char* message, size_t message_size);

  void (*close)(void* device);

  /* Pedal, clutch and burr, in the tick of a read that gave a pose. May be null. Since version 2.
   */
  void (*controls)(void* device, uint64_t tick, SulcusControls* controls);
} SulcusDevicePlugin;

/* The one symbol of a plug-in. What it points to stays as long as the program runs. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const SulcusDevicePlugin*
sulcus_device_plugin(void);

#ifdef __cplusplus
}
#endif

#endif
