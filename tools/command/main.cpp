// The asperity command: see docs/reference/command.md.
#include "cli.hpp"
#include "heap_room.hpp"
#include "interrupt.hpp"

int main(int argc, char** argv) {
  asperity::command::prepare_heap();
  asperity::command::catch_interrupts();
  asperity::command::command_line line;
  asperity::command::add_bake(line);
  asperity::command::add_inspect(line);
  asperity::command::add_query(line);
  asperity::command::add_run(line);
  asperity::command::add_models(line);
#if defined(ASPERITY_HAS_VIEW)
  asperity::command::add_view(line);
#endif
  asperity::command::add_devices(line);
  asperity::command::add_bench(line);
  asperity::command::add_experiment(line);
  return line.run(argc, argv);
}
