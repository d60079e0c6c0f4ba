# shellcheck shell=bash
# Bakes meshes that nobody made for this project, and writes a table of what was wrong with each and what was done. Sourced
# by ./dev. Needs the network once, or a folder with the files; no test depends on it.

# The file of one line of real_meshes.txt, into $2, from the folder $1 or from its repository. Checks what came.
real_mesh_fetch() {
  local from=$1 file=$2 name=$3 repository=$4 commit=$5 path=$6 sum=$7
  [[ -f $file ]] && sha256sum --quiet -c <<< "$sum  $file" 2> /dev/null && return 0
  if [[ -n $from ]]; then
    [[ -f $from/$name ]] || die "real-meshes: $from has no $name"
    cp "$from/$name" "$file"
  else
    curl -fsSL --retry 2 -o "$file" "https://raw.githubusercontent.com/$repository/$commit/$path" ||
      die "real-meshes: $name could not be fetched from $repository, is there a network? --from FOLDER takes files that are there"
  fi
  sha256sum --quiet -c <<< "$sum  $file" ||
    die "real-meshes: $file is not the $name that was measured; its SHA-256 differs from tools/dev/real_meshes.txt"
}

# Value of a key in a document that the command wrote, below the line of the key before it (- for none).
real_mesh_value() {
  awk -v above="\"$2\":" -v key="\"$3\":" '
    $1 == above { seen = 1 }
    (above == "\"-\":" || seen) && $1 == key { gsub(/[",]/, "", $2); print $2; exit }' "$1"
}

# Metres in micrometres, three digits.
real_mesh_um() { awk -v x="$1" 'BEGIN { printf "%.3g", 1e6 * x }'; }
real_mesh_percent() { awk -v x="$1" 'BEGIN { printf "%.2g", 100 * x }'; }

# The fault that an error document names, without its place and its mend.
real_mesh_fault() {
  sed -n 's/.*"message": "the mesh \(.*\)".*/\1/p' "$1" |
    sed 's/;.*//; s/, the first is.*//; s/^is not closed: //; s/^has //; s/ with more than two triangles/ of more than 2 triangles/'
}

# What a repair did, as "hole 5, weld 12".
real_mesh_actions() {
  awk '
    $1 == "\"action\":" { gsub(/[",]/, "", $2); gsub(/_/, " ", $2); what = $2 }
    $1 == "\"count\":" && what != "" { gsub(/,/, "", $2); printf "%s%s %s", between, what, $2; between = ", "; what = "" }' "$1"
}

# run_real_meshes [--from FOLDER] [NAME...]: all of the list, or those named.
run_real_meshes() {
  local from= asperity=build/release/bin/asperity folder=build/real_meshes out=out/real_meshes
  local name repository commit path sum table report refused bad wanted
  if [[ ${1:-} == --from ]]; then
    [[ -d ${2:-} ]] || die "real-meshes: --from needs a folder"
    from=$2
    shift 2
  fi
  configure_and_build release bin/asperity
  mkdir -p "$folder" "$out"
  table=$out/table.md
  {
    echo "| mesh | triangles | what is wrong | done | surface to mesh, p99, max (um) | mesh to surface, p99, max (um) | made up, lost (%) | bake RMS, max (um) | s |"
    echo "|---|---|---|---|---|---|---|---|---|"
  } > "$table"
  while read -r name repository commit path sum; do
    [[ -z $name || $name == \#* ]] && continue
    wanted=" $* "
    [[ $# -eq 0 || $wanted == *" $name "* ]] || continue
    real_mesh_fetch "$from" "$folder/$name" "$name" "$repository" "$commit" "$path" "$sum"
    step "$name"
    report=$out/$name.json refused=$out/$name.refused.json
    local options=(--fit 0.15 --texture 512 --without-field -o "$out/${name%.*}.glb" --json --quiet)
    local fault=none did="as it is" far="" near="" shares=""
    rm -f "$refused"
    if ! "$asperity" bake "$folder/$name" --strict "${options[@]}" > "$report" 2> /dev/null; then
      mv "$report" "$refused"
      fault=$(real_mesh_fault "$refused")
      if "$asperity" bake "$folder/$name" "${options[@]}" > "$report" 2> /dev/null; then
        did="repaired: $(real_mesh_actions "$report")"
        shares="$(real_mesh_percent "$(real_mesh_value "$report" repair made_up_share)"),"
      elif "$asperity" bake "$folder/$name" --wrap "${options[@]}" > "$report" 2> /dev/null; then
        local plates
        did="wrapped, cells of $(real_mesh_um "$(real_mesh_value "$report" wrap cell)") um"
        plates=$(real_mesh_value "$report" wrap plate_share)
        [[ $plates == 0.0 ]] || did+=", $(real_mesh_percent "$plates") % plates"
        far=wrapped
      else
        bad=$(sed -n 's/.*"message": "\(.*\)".*/\1/p' "$report")
        echo "| $name | | ${fault:-?} | refused: $bad | | | | | |" >> "$table"
        continue
      fi
    fi
    local rms max seconds triangles
    rms=$(real_mesh_um "$(real_mesh_value "$report" bake rms_error)")
    max=$(real_mesh_um "$(real_mesh_value "$report" bake max_error)")
    seconds=$(awk '$1 == "\"seconds\":" { last = $2 } END { gsub(/,/, "", last); printf "%.1f", last }' "$report")
    triangles=$(real_mesh_value "$report" - full_triangles)
    if [[ -n $far ]]; then
      triangles=$(real_mesh_value "$report" wrap triangles_in)
      far=$(real_mesh_spread "$report" to_original)
      near=$(real_mesh_spread "$report" to_wrap)
      shares="$(real_mesh_percent "$(real_mesh_value "$report" wrap made_up_share)"), $(real_mesh_percent "$(real_mesh_value "$report" wrap lost_share)")"
    fi
    echo "| $name | $triangles | $fault | $did | $far | $near | $shares | $rms, $max | $seconds |" >> "$table"
  done < tools/dev/real_meshes.txt
  say "the table: $table"
}

# "p99, max" of a spread within the document's key "wrap", in um.
real_mesh_spread() {
  awk -v key="\"$2\":" '
    $1 == "\"wrap\":" { wrap = 1 }
    wrap && $1 == key { here = 1 }
    here && $1 == "\"p99\":" { p99 = $2 }
    here && $1 == "\"max\":" { gsub(/,/, "", p99); printf "%.3g, %.3g", 1e6 * p99, 1e6 * $2; exit }' "$1"
}
