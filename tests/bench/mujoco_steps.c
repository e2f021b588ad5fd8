// Steps a model as often as it is told with MuJoCo's C library, each joint driven to 0.5 rad by a spring and
// a damper, and prints the steps per second. tests/bench/environment compiles and runs it. usage:
// mujoco_steps MODEL STEPS TICKS_PER_STEP
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char** argv) {
  char error[500] = "";
  if (argc != 4) return 2;
  mjModel* model = mj_loadXML(argv[1], NULL, error, sizeof error);
  if (!model) {
    fprintf(stderr, "mujoco_steps: %s\n", error);
    return 1;
  }
  model->opt.timestep = 1e-3;
  mjData* data = mj_makeData(model);
  const long steps = atol(argv[2]), ticks = atol(argv[3]);
  const double began = now();
  for (long i = 0; i < steps; ++i) {
    for (long k = 0; k < ticks; ++k) {
      for (int j = 0; j < model->nv; ++j)
        data->qfrc_applied[j] = 100.0 * (0.5 - data->qpos[j]) - 10.0 * data->qvel[j];
      mj_step(model, data);
    }
  }
  printf("%.1f %d %.6f\n", (double)steps / (now() - began), model->nv, data->qpos[0]);
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
