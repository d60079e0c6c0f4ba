#!/usr/bin/env bash
# The command as a user runs it: files, documents, exit statuses, an interrupt.
#   command.sh ASPERITY FOLDER-OF-MODELS
set -uo pipefail
command=$1
models=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
fault() { echo "command.sh: $*"; failed=1; }

# One experiment: its folder, and a document.
"$command" experiment patterns --brief --models "$models" -o "$work/one" --json > "$work/one.json" 2> "$work/one.err"
status=$?
[[ $status == 0 ]] || fault "patterns ended with status $status: $(cat "$work/one.err")"
[[ -s $work/one/patterns/verdict.json ]] || fault "no verdict.json"
ls "$work"/one/patterns/*.svg "$work"/one/patterns/*.png > /dev/null || fault "no figure"
[[ ! -e $work/one/index.html ]] || fault "a page was made of one experiment"
grep -q '"schema": *"asperity.experiment/1"' "$work/one.json" || fault "no schema in $(head -c 200 "$work/one.json")"
grep -q '"pass": *true' "$work/one.json" || fault "no statement in the document"
[[ -z $(find "$work/one" -name '*.partial*') ]] || fault "something half-written is left"

# interrupt_at PID FILE: interrupts that process as soon as the file is there. A busy machine may take minutes over it, and
# the process ends by itself where the file never comes.
interrupt_at() {
  for ((i = 0; i < 9000; ++i)); do
    [[ -e $2 ]] && break
    kill -0 "$1" 2> /dev/null || break
    sleep 0.1
  done
  kill -INT "$1"
  wait "$1"
}

# Interrupted between two: what was finished is whole, and the page says what is missing.
"$command" experiment stability patterns --brief --models "$models" -o "$work/two" > "$work/two.out" 2> "$work/two.err" &
interrupt_at $! "$work/two/patterns/verdict.json"
status=$?
[[ $status == 130 ]] || fault "interrupted, the status is $status: $(cat "$work/two.err")"
[[ -s $work/two/patterns/verdict.json ]] || fault "what was finished is not there"
grep -q 'Missing: stability\.' "$work/two/index.html" || fault "the page does not say what is missing"
[[ ! -e $work/two/stability ]] || fault "there is a folder of what was not finished"
[[ -z $(find "$work/two" -name '*.partial*') ]] || fault "something half-written is left"

# All of them, interrupted at the start.
"$command" experiment all --brief --no-gpu --models "$models" -o "$work/all" > "$work/all.out" 2> "$work/all.err" &
interrupt_at $! "$work/all"
status=$?
[[ $status == 130 ]] || fault "interrupted, the status is $status: $(cat "$work/all.err")"
grep -q 'Missing: fig7, fig8, fig9, hammer, roughness, baselines, patterns, stability\.' "$work/all/index.html" ||
  fault "the page does not name all that is missing"

# What is wrong with the command line.
"$command" experiment fig99 -o "$work/none" > /dev/null 2> "$work/unknown.err"
[[ $? == 2 ]] || fault "an unknown experiment is no usage error"
grep -q 'fig7' "$work/unknown.err" || fault "the names are not listed: $(cat "$work/unknown.err")"
[[ $(wc -l < "$work/unknown.err") == 1 ]] || fault "more than one line: $(cat "$work/unknown.err")"
"$command" experiment fig7 -o "$work/unknown.err/folder" > /dev/null 2> "$work/folder.err"
[[ $? == 1 ]] || fault "a folder in a file is no failure"
grep -q 'unknown.err/folder' "$work/folder.err" || fault "the folder is not named: $(cat "$work/folder.err")"
exit $failed
