/* A consumer's program in C: a spring on the simulated device, and a model that is not there. */
#include <stdio.h>
#include <string.h>

#include <asperity/c/asperity.h>

int main(void) {
  asperity_error why = {sizeof why, 0, ""};
  asperity_haptic_device* device = NULL;
  asperity_model* model = NULL;
  asperity_measurement sample = {sizeof sample, 0, 0, 0, {0}, {0}};
  int64_t t;

  if (asperity_model_load("nowhere.glb", &model, &why) != ASPERITY_ERROR_IO_FAILED || strstr(why.message, "nowhere") == 0)
    return puts("a file that is not there was not refused"), 1;
  if (asperity_device_make_simulated(NULL, &device, &why) != 0 || asperity_device_open(device, &why) != 0 ||
      asperity_device_arm(device, &why) != 0)
    return puts(why.message), 1;
  for (t = 0; t < 1000000000; t += 1000000) {
    double push[6] = {0, 0, 0, 0, 0, 0};
    if (asperity_device_read(device, t, &sample) != 0) return puts("the device did not answer"), 1;
    push[2] = -1000.0 * sample.pose[2];
    if (asperity_device_write(device, t, push, t + 20000000) != 0) return puts("the device took no wrench"), 1;
  }
  asperity_device_free(device);
  printf("asperity %s: the hand is held %.2f mm down\n", asperity_version(), -1e3 * sample.pose[2]);
  return sample.pose[2] < -1e-3 && sample.pose[2] > -4e-3 ? 0 : 1;
}
