# To be sourced: compiles a file of claims (layout_claims.h) as strict C99 and as C++20, and plants changes in copies of the
# headers that it is about, each of which has to break both.
# It takes compiler, include (folder of the headers), folder (of them, below include), claims (the file), work (to write in).
as_c=(-x c -std=c99 -Wall -Wextra -Wpedantic -Werror -fsyntax-only)
as_cxx=(-x c++ -std=c++20 -Wall -Wextra -Wpedantic -Werror -fsyntax-only)
planted=0

compile() { # FOLDER OPTIONS...
  local from=$1
  shift
  "$compiler" "$@" -I"$from" -include "$claims" /dev/null
}

holds() {
  for options in as_c as_cxx; do
    declare -n flags=$options
    compile "$include" "${flags[@]}"
  done
}

# plant HEADER SED-SCRIPT: changes a copy, and expects neither language to take it.
plant() {
  rm -rf "$work"
  mkdir -p "$work/$(dirname "$folder")"
  cp -r "$include/$folder" "$work/$folder"
  sed -i -E "$2" "$work/$folder/$1"
  if cmp -s "$include/$folder/$1" "$work/$folder/$1"; then
    echo "the change '$2' changes nothing" >&2
    exit 1
  fi
  for options in as_c as_cxx; do
    declare -n flags=$options
    if compile "$work" "${flags[@]}" 2> "$work/errors"; then
      echo "the change '$2' was not seen" >&2
      exit 1
    fi
    grep -qE '_has_moved|_has_another' "$work/errors" || {
      echo "the change '$2' broke something else:" >&2
      cat "$work/errors" >&2
      exit 1
    }
  done
  planted=$((planted + 1))
}
