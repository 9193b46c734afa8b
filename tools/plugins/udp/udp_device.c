/* A device that is another program: it sends poses to a port of this machine and is sent wrenches
 * back. client.py is one, in 30 lines.
 *
 * settings = "port=47800 timeout_ms=2", each of them optional. The socket is bound to 127.0.0.1,
 * so that nobody from outside reaches it. Datagrams are little-endian, without padding: 80 bytes,
 * but of poses of version 2, which say more, 96:
 *
 *   from the device (poses)                     to the device (one a tick, once poses come)
 *    0  u8[4]  "SULP"                            0  u8[4]  "SULW"
 *    4  u32    1 or 2                            4  u32    1
 *    8  u64    number, rising                    8  u64    number of the newest pose
 *   16  f64[3] burr's tip, m, world             16  u64    tick
 *   40  f64[4] w x y z, world from tool         24  f64[3] force on the hand, N, world
 *   72  u32    bits: 1 the user has ended it,   48  f64[3] torque, N m
 *              2 the clutch is held             72  u32    1: the run is over, all are zero
 *   76  u32    0                                76  u32    0
 *   of version 2 alone:
 *   80  f64    pedal: share of the speed, 0 to 1
 *   88  u32    burr: 0 the scene's, n its n-th [[spare_burr]], 0xFFFFFFFF as it is
 *   92  u32    0
 *
 * A tick takes the newest pose that has come; one that is older than timeout_ms is none, which
 * Sulcus bridges for 20 ms more. Wrenches go to the sender of that pose. Until it has been silent
 * for kPeerSilent_ms or timeout_ms, whichever is longer, nobody else's poses are taken. What is no
 * such datagram is left out and counted.
 *
 * In a tick there are system calls, none of which waits: the socket is read until it is empty, at
 * most kMost times (kMostAfterAPause where nobody has read for kPaused_ns), and written to once. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "sulcus_device.h"

#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the datagrams are copied as they are, which a little-endian machine can do"
#endif

enum { kMost = 64, kMostAfterAPause = 4096, kPaused_ns = 5000000 };
enum { kEnded = 1, kClutch = 2, kOver = 1, kPeerSilent_ms = 20 };

typedef struct PoseDatagram {
  char magic[4];
  uint32_t version;
  uint64_t number;
  SulcusPose pose;
  uint32_t flags, zero;
  double pedal; /* from here on of version 2 */
  uint32_t burr, zero_2;
} PoseDatagram;
enum { kPoseBytes_1 = 80, kPoseBytes_2 = 96 };

typedef struct WrenchDatagram {
  char magic[4];
  uint32_t version;
  uint64_t number, tick;
  SulcusWrench wrench;
  uint32_t flags, zero;
} WrenchDatagram;

_Static_assert(sizeof(PoseDatagram) == kPoseBytes_2 && sizeof(WrenchDatagram) == 80,
               "as documented");

typedef struct Device {
  int socket;
  long port, timeout_ms;
  struct sockaddr_in peer; /* who has sent the newest pose */
  PoseDatagram newest;
  int has_peer;
  int64_t newest_ns;            /* when it came */
  int64_t peer_ns;              /* the same, later by what nobody read */
  int64_t read_ns;              /* last, 0 before */
  uint64_t refused, of_version; /* datagrams left out, and those among them of another version */
  uint64_t poses;               /* taken */
} Device;

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* "key=NUMBER key=NUMBER ..."; 0 where it is anything else. */
static int read_settings(const char* text, Device* device) {
  while (*text != '\0') {
    long* value = NULL;
    long least = 1, most = 0;
    if (strncmp(text, "port=", 5) == 0) {
      value = &device->port, least = 1024, most = 65535, text += 5;
    } else if (strncmp(text, "timeout_ms=", 11) == 0) {
      value = &device->timeout_ms, least = 1, most = 1000, text += 11;
    }
    char* end = NULL;
    if (!value || *text < '0' || *text > '9') return 0;
    *value = strtol(text, &end, 10);
    if (*value < least || *value > most || (*end != ' ' && *end != '\0')) return 0;
    text = *end == ' ' ? end + 1 : end;
  }
  return 1;
}

static int open_device(const SulcusDeviceHost* host, SulcusDeviceLimits* limits, void** opened,
                       char* message, size_t message_size) {
  Device* device = calloc(1, sizeof(Device));
  if (!device) {
    snprintf(message, message_size, "no memory");
    return SULCUS_DEVICE_GONE;
  }
  device->port = 47800;
  device->timeout_ms = 2;
  if (!read_settings(host->settings, device)) {
    snprintf(message, message_size,
             "settings '%.60s', expected port=1024..65535 timeout_ms=1..1000, either or both",
             host->settings);
    free(device);
    return SULCUS_DEVICE_GONE;
  }
  struct sockaddr_in own;
  memset(&own, 0, sizeof(own));
  own.sin_family = AF_INET;
  own.sin_port = htons((uint16_t)device->port);
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  device->socket = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (device->socket < 0 || bind(device->socket, (struct sockaddr*)&own, sizeof(own)) != 0) {
    snprintf(message, message_size, "UDP port %ld of 127.0.0.1: %s", device->port, strerror(errno));
    if (device->socket >= 0) close(device->socket);
    free(device);
    return SULCUS_DEVICE_GONE;
  }
  /* Of a common device; a scene may ask for less. */
  limits->force_N = 3.3;
  limits->torque_Nm = 0.1;
  limits->stiffness_N_per_m = 700.0;
  limits->resolution_m = 0.0;
  *opened = device;
  return SULCUS_DEVICE_OK;
}

static int is_silent_for(const Device* device, long ms) {
  return now_ns() - device->newest_ns > ms * 1000000;
}

/* Whether its poses are taken. */
static int is_held(const Device* device) {
  const long ms = device->timeout_ms > kPeerSilent_ms ? device->timeout_ms : kPeerSilent_ms;
  return device->has_peer && now_ns() - device->peer_ns <= ms * 1000000;
}

/* Takes a datagram, where it is one and newer than what is there. */
static void take(Device* device, PoseDatagram* datagram, ssize_t size,
                 const struct sockaddr_in* from) {
  if (size < kPoseBytes_1 || memcmp(datagram->magic, "SULP", 4) != 0) {
    ++device->refused;
    return;
  }
  if (datagram->version != 1 && datagram->version != 2) {
    ++device->refused;
    ++device->of_version;
    return;
  }
  if (size != (datagram->version == 1 ? kPoseBytes_1 : kPoseBytes_2)) {
    ++device->refused;
    return;
  }
  if (datagram->version == 1) {
    datagram->pedal = 1.0;
    datagram->burr = SULCUS_BURR_AS_IT_IS;
  }
  const int is_peer = device->has_peer && from->sin_port == device->peer.sin_port &&
                      from->sin_addr.s_addr == device->peer.sin_addr.s_addr;
  if (is_held(device)) {
    if (!is_peer || datagram->number <= device->newest.number) return;
  } else if (is_peer && datagram->number == device->newest.number) {
    return;
  }
  device->has_peer = 1;
  device->peer = *from;
  device->newest = *datagram;
  device->newest_ns = now_ns();
  device->peer_ns = device->newest_ns;
  ++device->poses;
}

/* One that does not go out is lost, as a datagram may be: the next tick has another. */
static void answer(const Device* device, uint64_t tick, const SulcusWrench* wrench, int over) {
  const WrenchDatagram datagram = {{'S', 'U', 'L', 'W'}, 1, device->newest.number, tick, *wrench,
                                   over ? kOver : 0u,    0};
  (void)sendto(device->socket, &datagram, sizeof(datagram), 0,
               (const struct sockaddr*)&device->peer, sizeof(device->peer));
}

static int read_pose(void* opened, uint64_t tick, SulcusPose* pose) {
  Device* device = opened;
  (void)tick;
  /* While nobody reads, as between two parts of a run, the peer is not silent, and what it sends is
   * old: all of that is taken out at once. */
  const int64_t now = now_ns();
  const int64_t unread = device->read_ns != 0 ? now - device->read_ns : 0;
  const int paused = unread > kPaused_ns || device->poses == 0;
  if (unread > kPaused_ns) device->peer_ns += unread;
  device->read_ns = now;
  for (int n = 0; n < (paused ? kMostAfterAPause : kMost); ++n) {
    PoseDatagram datagram;
    struct sockaddr_in from;
    socklen_t from_size = sizeof(from);
    const ssize_t size = recvfrom(device->socket, &datagram, sizeof(datagram), MSG_TRUNC,
                                  (struct sockaddr*)&from, &from_size);
    if (size < 0 && errno != ECONNREFUSED) break; /* empty */
    if (size >= 0) take(device, &datagram, size, &from);
  }
  if (!device->has_peer) return SULCUS_DEVICE_NO_POSE;
  if (device->newest.flags & kEnded) return SULCUS_DEVICE_OVER;
  if (is_silent_for(device, device->timeout_ms)) return SULCUS_DEVICE_NO_POSE;
  *pose = device->newest.pose;
  return SULCUS_DEVICE_OK;
}

static void read_controls(void* opened, uint64_t tick, SulcusControls* controls) {
  const Device* device = opened;
  (void)tick;
  controls->pedal = device->newest.pedal;
  controls->burr = device->newest.burr;
  controls->clutch = (device->newest.flags & kClutch) != 0;
}

static int write_wrench(void* opened, uint64_t tick, const SulcusWrench* wrench, int last) {
  const Device* device = opened;
  if (device->has_peer) answer(device, tick, wrench, last);
  return SULCUS_DEVICE_OK;
}

static void say(void* opened, char* message, size_t message_size) {
  const Device* device = opened;
  const char* what = "";
  if (!device->has_peer) what = "no pose ever came; ";
  if (device->has_peer && device->refused == 0) {
    message[0] = '\0';
    return;
  }
  snprintf(message, message_size,
           "%s127.0.0.1:%ld, %llu poses taken, %llu datagrams refused, %llu of them of another "
           "version than 1 and 2",
           what, device->port, (unsigned long long)device->poses,
           (unsigned long long)device->refused, (unsigned long long)device->of_version);
}

static void close_device(void* opened) {
  Device* device = opened;
  close(device->socket);
  free(device);
}

const SulcusDevicePlugin* sulcus_device_plugin(void) {
  static const SulcusDevicePlugin plugin = {
      .version = SULCUS_DEVICE_VERSION,
      .struct_size = sizeof(SulcusDevicePlugin),
      .flags = SULCUS_DEVICE_REAL_TIME,
      .name = "UDP on 127.0.0.1 2.0",
      .open = open_device,
      .read = read_pose,
      .write = write_wrench,
      .message = say,
      .close = close_device,
      .controls = read_controls,
  };
  return &plugin;
}
