/* Runs scenes with their own devices through libsulcus and prints what came out:
 * `scene,volume_hash,force_hash` of each, one a line. What cannot be opened is said on stderr, and
 * the exit status is then 1. */
#include <inttypes.h>
#include <stdio.h>

#include "sulcus.h"

static int run(const char* file) {
  char error[512] = "";
  SulcusSimulation* simulation = NULL;
  int code = sulcus_open_file(file, &simulation, error, sizeof error);
  uint64_t ticks = 0, volume = 0, force = 0;
  if (code == SULCUS_DONE) code = sulcus_scene_ticks(simulation, &ticks);
  for (uint64_t tick = 0; code == SULCUS_DONE && tick < ticks; ++tick) {
    code = sulcus_step_scene(simulation, NULL);
  }
  if (code == SULCUS_DONE) code = sulcus_volume_hash(simulation, &volume);
  if (code == SULCUS_DONE) code = sulcus_force_hash(simulation, &force);
  sulcus_free(&simulation);
  if (code == SULCUS_DONE) {
    printf("%s,%016" PRIx64 ",%016" PRIx64 "\n", file, volume, force);
    fflush(stdout);
  } else {
    fprintf(stderr, "%s: %s. %s\n", file, sulcus_error_text(code), error);
  }
  return code != SULCUS_DONE;
}

int main(int count, char** arguments) {
  int failed = 0;
  for (int i = 1; i < count; ++i) failed |= run(arguments[i]);
  return failed;
}
