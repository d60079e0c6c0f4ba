# Bash completion for asperity. Subcommands and options are asked from the command itself, so they cannot grow stale.
_asperity() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[0]} subcommand="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} == -* ]] || { subcommand=${COMP_WORDS[i]}; break; }
  done
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$command" ${subcommand:+"$subcommand"} --help 2> /dev/null |
      grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')" -- "$word")
  elif [[ -z $subcommand ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$command" --help 2> /dev/null |
      sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p')" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _asperity asperity
