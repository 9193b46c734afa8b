/* A thread of 1 kHz with a coupling, and another that asks what happened: the burr's hand goes down
 * onto a plate and along it, held by springs, for a second.
 *   cc haptic_thread.c -lsulcus -lpthread -o haptic_thread && ./haptic_thread */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <time.h>

#include "sulcus.h"

static const char* const scene =
    "[workpiece]\nshape = \"box\"\nvoxel_mm = 0.05\ncells = [128, 128, 64]\n"
    "box.size_mm = [5, 5, 2]\n[burr]\ndiameter_mm = 1.0\nspeed_rpm = 0\nfield = [48, 192, 48]\n"
    "[trajectory]\npoints_mm = [[-1, 0, 1.3]]\n[device]\nmodel = \"simulated\"\npreset = "
    "\"falcon\"\n[coupling]\n";

/* What the thread tells the other: only numbers that are whole by themselves. */
static struct Shared {
  SulcusSimulation* simulation;
  _Atomic int code, done;
  _Atomic unsigned long ticks, late; /* ended after the next should have begun */
  _Atomic double up_N;
} shared;

static void* haptic(void* unused) {
  struct timespec next;
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (int tick = 0; tick < 1000; ++tick) {
    const double t = 1e-3 * tick, down = t < 0.3 ? t / 0.3 : 1.0, along = t > 0.4 ? t - 0.4 : 0.0;
    /* In its place: the pose that the device's driver gives. */
    const double pose[7] = {-1e-3 + 2e-3 * along,
                            0,
                            1.3e-3 - 0.8e-3 * down,
                            0.70710678118654757,
                            0.70710678118654757,
                            0,
                            0};
    double wrench[6];
    const int code = sulcus_step(shared.simulation, pose, wrench);
    if (code != SULCUS_DONE) {
      shared.code = code;
      break;
    }
    shared.up_N = wrench[2]; /* in its place: to the device's driver */
    ++shared.ticks;
    next.tv_nsec += 1000000;
    if (next.tv_nsec >= 1000000000) {
      next.tv_nsec -= 1000000000;
      ++next.tv_sec;
    }
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (now.tv_sec > next.tv_sec || (now.tv_sec == next.tv_sec && now.tv_nsec > next.tv_nsec)) {
      ++shared.late;
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  shared.done = 1;
  return unused;
}

int main(void) {
  SulcusSource source = {.struct_size = sizeof source, .text = scene, .file = "plate"};
  char error[512] = "";
  const int code = sulcus_open(&source, &shared.simulation, error, sizeof error);
  pthread_t thread;
  if (code != SULCUS_DONE || pthread_create(&thread, NULL, haptic, NULL) != 0) {
    fprintf(stderr, "%s. %s\n", sulcus_error_text(code), error);
    return 1;
  }
  while (!shared.done) {
    const struct timespec pause = {0, 100000000};
    nanosleep(&pause, NULL);
    printf("%4lu ticks  %6.3f N up\n", shared.ticks, shared.up_N);
  }
  pthread_join(thread, NULL);
  printf("%lu ticks, %lu late. %s\n", shared.ticks, shared.late, sulcus_error_text(shared.code));
  sulcus_free(&shared.simulation);
  return shared.code != SULCUS_DONE || shared.ticks != 1000;
}
