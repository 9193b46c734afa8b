/* A round burr is pressed 0.1 mm into a ball: what the hand feels, and the deepest contact.
 *   cc press.c -lsulcus -o press && ./press */
#include <stdio.h>

#include "sulcus.h"

static const char* const scene =
    "[workpiece]\nshape = \"sphere\"\nvoxel_mm = 0.05\ncells = [128, 128, 128]\n"
    "sphere.radius_mm = 3\n[burr]\ndiameter_mm = 1.0\nfield = [48, 192, 48]\n"
    "[trajectory]\npoints_mm = [[0, 0, 3.2]]\n";

int main(void) {
  SulcusSource source = {.struct_size = sizeof source, .text = scene, .file = "ball"};
  SulcusSimulation* ball = NULL;
  char error[512] = "";
  int code = sulcus_open(&source, &ball, error, sizeof error);
  for (int tick = 0; code == SULCUS_DONE && tick <= 300; ++tick) {
    /* The burr's axis, +y of the tool, is up: a quarter turn about x. */
    const double pose[7] = {0, 0, 3.2e-3 - 1e-6 * tick, 0.70710678118654757, 0.70710678118654757,
                            0, 0};
    double wrench[6];
    static SulcusContact contacts[4096];
    size_t count = 0;
    code = sulcus_step(ball, pose, wrench);
    if (code == SULCUS_DONE) code = sulcus_contacts(ball, contacts, 4096, &count);
    size_t deepest = 0;
    for (size_t i = 1; i < count; ++i) {
      if (contacts[i].depth_m > contacts[deepest].depth_m) deepest = i;
    }
    if (code == SULCUS_DONE && tick % 50 == 0) {
      printf("%3d ms  %6.3f N up  %3zu contacts  %5.1f um deep\n", tick, wrench[2], count,
             count ? 1e6 * contacts[deepest].depth_m : 0.0);
    }
  }
  if (code != SULCUS_DONE) fprintf(stderr, "%s. %s\n", sulcus_error_text(code), error);
  sulcus_free(&ball);
  return code != SULCUS_DONE;
}
