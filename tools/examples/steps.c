/* What a step costs: for each line that it reads, a scene's path is stepped from its beginning, and
 * the mean of the microseconds of a step printed, of each ten steps the least so far, with the hash
 * of the forces. steps.py runs it beside the same from Python. cc steps.c -lsulcus -o steps && yes
 * '' | head -30 | ./steps SCENE.toml 500 */
#define _POSIX_C_SOURCE 199309L
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "sulcus.h"

#define TEN 10

static double now_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e6 * (double)now.tv_sec + 1e-3 * (double)now.tv_nsec;
}

/* One round over `tens` times ten poses of seven numbers. */
static int round_of(SulcusSimulation* run, const double* poses, size_t tens, double* least_us) {
  double wrench[6], sum_us = 0;
  uint64_t forces = 0;
  int code = SULCUS_DONE;
  for (size_t i = 0; code == SULCUS_DONE && i < tens; ++i) {
    const double from_us = now_us();
    for (int k = 0; code == SULCUS_DONE && k < TEN; ++k, poses += 7) {
      code = sulcus_step(run, poses, wrench);
    }
    const double us = now_us() - from_us;
    if (us < least_us[i]) least_us[i] = us;
    sum_us += least_us[i];
  }
  if (code == SULCUS_DONE) code = sulcus_force_hash(run, &forces);
  if (code == SULCUS_DONE) printf("%.9g %016" PRIx64 "\n", sum_us / (double)(TEN * tens), forces);
  fflush(stdout);
  return code;
}

int main(int arguments, char** argument) {
  char error[512] = "";
  SulcusSimulation* run = NULL;
  const long steps = arguments == 3 ? atol(argument[2]) : 0;
  if (steps < TEN) return fputs("usage: steps SCENE.toml STEPS, from 10 on\n", stderr), 2;
  const size_t tens = (size_t)steps / TEN;
  double rate_hz = 0, *poses = calloc(tens * TEN, 7 * sizeof *poses);
  double* const least_us = calloc(tens, sizeof *least_us);
  void* start = NULL;
  size_t size = 0;
  int code = poses && least_us ? SULCUS_DONE : SULCUS_FAILED;
  if (code == SULCUS_DONE) code = sulcus_open_file(argument[1], &run, error, sizeof error);
  if (code == SULCUS_DONE) code = sulcus_rate_hz(run, &rate_hz);
  for (size_t i = 0; code == SULCUS_DONE && i < tens * TEN; ++i) {
    code = sulcus_scene_pose(run, (double)i * (1.0 / rate_hz), poses + 7 * i);
    least_us[i / TEN] = 1e9;
  }
  if (code == SULCUS_DONE) code = sulcus_save(run, NULL, 0, &size);
  if (code == SULCUS_TOO_SMALL) start = malloc(size);
  if (start) code = sulcus_save(run, start, size, &size);
  while (code == SULCUS_DONE && getchar() == '\n') {
    code = sulcus_restore(run, start, size, error, sizeof error);
    if (code == SULCUS_DONE) code = round_of(run, poses, tens, least_us);
  }
  if (code != SULCUS_DONE) fprintf(stderr, "%s. %s\n", sulcus_error_text(code), error);
  free(start);
  free(least_us);
  free(poses);
  sulcus_free(&run);
  return code != SULCUS_DONE;
}
