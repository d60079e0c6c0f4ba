#!/usr/bin/env bash
# include_graph_faults.sh ROOT WORK: include_graph.sh on copies with a fault planted; each has to be found.
set -euo pipefail
root=$1 work=$2/include_graph
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

# plant NAME EXPECTED FILE LINE [SED-SCRIPT FOR THE TABLE]
plant() {
  rm -rf "$work"
  mkdir -p "$work/docs/explanation" "$work/tools"
  cp -r "$root/include" "$root/src" "$root/hal" "$root/backends" "$work"
  cp -r "$root"/tools/{io,bake,picture,text,view,c} "$work/tools"
  sed "${5:-}" "$root/docs/explanation/architecture.md" > "$work/docs/explanation/architecture.md"
  [[ -z $4 ]] || echo "$4" >> "$work/$3"
  if said=$("$here/include_graph.sh" "$work"); then
    [[ -z $2 ]] || { echo "$1 was not found: $said"; exit 1; }
  elif [[ -z $2 || $said != *"$2"* ]]; then
    echo "$1 was told as: $said"
    exit 1
  fi
}
plant "nothing" "" include/asperity/core/math.hpp ""
plant "an include that is not allowed" "does not allow to render" include/asperity/render/contact.hpp '#include "asperity/window/cpu_depth.hpp"'
plant "an include of an inside" "does not allow to core" include/asperity/core/math.hpp '#include "field/lanes.hpp"'
plant "an include of a room that may include nothing" "does not allow to text" tools/text/amount.hpp '#include "asperity/model/scene.hpp"'
plant "an include of the command" "does not allow to picture" tools/picture/sheet.cpp '#include "command/output_file.hpp"'
plant "a header that brings many" "more than 70" include/asperity/asperity.hpp '#include "asperity/device/simulated/simulated_device.hpp"'
plant "a cycle that the table allows" "in a cycle" include/asperity/core/math.hpp '#include "asperity/model/scene.hpp"' \
  's/^| `core` | .* |$/| `core` | `model` |/'
plant "a room that is not listed" "is not in the table" src/field/lanes.hpp "" '/^| `window` |/d'
echo "seven planted faults were found"
