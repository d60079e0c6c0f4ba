/* The C interface: one tick, then a tool that follows a hand in a loop of 90 frames a second, as a game has it. C99. */
#include <stdio.h>

#include <asperity/c/asperity.h>

static int fail(const asperity_error* why) {
  printf("%s: %s\n", asperity_describe(why->code), why->message);
  return 1;
}

int main(int argc, char** argv) {
  asperity_error why = {sizeof why, 0, ""};
  asperity_model *probe = NULL, *body = NULL;
  asperity_renderer* renderer = NULL;
  asperity_tool* tool = NULL;
  const asperity_tool_settings settings = {.size = sizeof settings,
                                           .period_s = 1e-3,
                                           .static_friction = 0.4,
                                           .dynamic_friction = 0.3,
                                           .most_force_n = 5.0,
                                           .most_torque_n_m = 0.2};
  asperity_touch touch = {sizeof touch, 0, {0}, {0}, 0, 0, 0};
  asperity_felt felt = {sizeof felt, 0, 0, 0, {0}, {0}, {0}, 0};
  const double upright[4] = {0, 0, 0, 1};
  double hand[7];
  double largest_n = 0.0;
  const asperity_model* fixed = NULL;
  int frame = 0, part = 0;

  if (argc != 3) return puts("usage: 07_c_interface PROBE.glb FIXED.glb"), 2;
  if (asperity_model_load(argv[1], &probe, &why) != 0 || asperity_model_load(argv[2], &body, &why) != 0)
    return fail(&why);
  fixed = body;

  /* One tick, half a millimetre below the first touch. */
  if (asperity_renderer_make(probe, &fixed, 1, NULL, &renderer, &why) != 0 ||
      asperity_renderer_find_touch(renderer, upright, hand, &why) != 0)
    return fail(&why);
  hand[2] -= 0.0005;
  printf("%s, ", asperity_describe(asperity_renderer_step(renderer, hand, &touch)));
  printf("%u contacts, %.4f N up\n", (unsigned)touch.contacts, touch.on_probe[2]);

  /* The hand pushes 5 mm further and drags to the side: planes hold the probe at the surface. */
  if (asperity_tool_make(probe, &fixed, 1, &settings, &tool, &why) != 0) return fail(&why);
  hand[2] += 0.002;
  asperity_tool_place(tool, hand);
  for (frame = 0; frame < 90; ++frame) {
    hand[0] += 0.0001;
    if (frame < 45) hand[2] -= 0.00015;
    for (part = 0; part < 11; ++part) /* about 1 kHz: eleven ticks of a frame of 11 ms */
      if (asperity_tool_follow(tool, hand, 1.0 / 990.0, &felt) != 0) return 1;
    if (felt.on_hand[2] > largest_n) largest_n = felt.on_hand[2];
  }
  printf("the hand felt up to %.2f N; the probe is %.2f mm above the hand\n", largest_n,
         1e3 * (felt.probe_pose[2] - hand[2]));

  /* In any order. */
  asperity_model_free(probe);
  asperity_model_free(body);
  asperity_renderer_free(renderer);
  asperity_tool_free(tool);
  return largest_n > 0.0 ? 0 : 1;
}
