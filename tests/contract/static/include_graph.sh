#!/usr/bin/env bash
# include_graph.sh ROOT: which room includes which, by the sources, against the table in docs/explanation/architecture.md.
# Fails for an include that the table does not allow, for a room that it does not list, for a cycle, and where
# asperity/asperity.hpp brings more than 70 headers.
set -euo pipefail
cd "$1"

# edges: "ROOM INCLUDED-ROOM FILE" for every include of another room.
edges() {
  local folder=$1 room=$2
  # A room that includes nothing is none of grep's faults.
  { grep -rnoE '#include "(asperity/)?[a-z_]+/[a-z_/0-9]+\.hp*"' "$folder" --include='*.hpp' --include='*.h' --include='*.cpp' ||
    [[ $? -eq 1 ]]; } |
    sed -E 's|^([^:]+):[0-9]+:#include "(asperity/)?([a-z_]+)/.*|\3 \1|' |
    awk -v room="$room" '$1 != room && $1 != "asperity" { print room, $1, $2 }'  # version.hpp is of no room
}

all_edges() {
  local folder
  for folder in include/asperity/*/ src/*/; do edges "$folder" "$(basename "$folder")"; done
  for folder in hal/{transport,drivers,can,serial,usb,hid,urdf,plugin} tools/{io,bake}; do
    edges "$folder/include" "$(basename "$folder")"
  done
  for folder in backends/gl_*/include; do edges "$folder" gl; done
  edges backends/mujoco/include mujoco
  for folder in tools/{picture,text,view,c}; do edges "$folder" "$(basename "$folder")"; done
}

allowed=$(sed -n '/^## Rooms and who may include whom/,/^## /p' docs/explanation/architecture.md |
  sed -nE 's/^\| `([a-z_]+)` \| (.*) \|$/\1 \2/p' | tr -d '`,')
[[ -n $allowed ]] || { echo "the table of rooms was not found"; exit 1; }

found=$(all_edges)
[[ $(wc -l <<< "$found") -gt 100 ]] || { echo "only $(wc -l <<< "$found") includes between rooms were found: the search is broken"; exit 1; }
bad=$(awk 'NR == FNR { room[$1] = 1; for (i = 2; i <= NF; ++i) may[$1, $i] = 1; next }
           !($1 in room) { print "the room " $1 " is not in the table (" $3 ")"; next }
           !(($1, $2) in may) { print $3 " includes " $2 ", which the table does not allow to " $1 }' \
      <(echo "$allowed") <(echo "$found"))
if [[ -n $bad ]]; then
  echo "$bad"
  exit 1
fi
if ! cycle=$(awk '{ print $1, $2 }' <<< "$found" | sort -u | tsort 2>&1 > /dev/null); then
  echo "rooms include each other in a cycle: $cycle"
  exit 1
fi

# What one header brings a consumer: itself not counted.
brought() {
  local header=$1 next
  [[ -z ${seen[$header]:-} ]] || return 0
  seen[$header]=1
  while read -r next; do brought "$next"; done < <(sed -nE 's|^#include "(asperity/[^"]+)"|\1|p' "include/$header")
}
declare -A seen=()
brought asperity/asperity.hpp
count=$((${#seen[@]} - 1))
[[ $count -gt 30 ]] || { echo "asperity.hpp seems to bring only $count headers: the search is broken"; exit 1; }
[[ $count -le 70 ]] || { echo "asperity.hpp brings $count headers of ours, more than 70"; exit 1; }
echo "asperity.hpp brings $count headers of ours"
echo "$(wc -l <<< "$found") includes between $(awk '{ print $1 }' <<< "$found" | sort -u | wc -l) rooms, no cycle"
