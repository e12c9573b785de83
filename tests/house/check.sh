#!/usr/bin/env bash
# The house's own rules, one a verb: `check.sh VERB` from anywhere; status 0 kept, 1 broken (each break on a line), 77 cannot tell.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

readonly rooms=(gl algorithms sweeps plots sandbox)  # each may include itself and those before it
readonly longest_file=450
broken=0

complain() {
  printf '%s\n' "$*"
  broken=1
}

skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}

sources() { find "${rooms[@]}" tests -type f \( -name '*.cpp' -o -name '*.hpp' \) | sort; }

# Includes run one way only.
check_includes() {
  local -A rank=([tests]=${#rooms[@]})  # tests see everything, and nothing sees them
  local i file line included
  for i in "${!rooms[@]}"; do rank[${rooms[$i]}]=$i; done
  while IFS=: read -r file line included; do
    included="${included#*\"}"
    included="${included%%\"*}"
    if [[ $included != */* || ! -v rank[${included%%/*}] ]]; then
      complain "$file:$line: \"$included\" is not given from the root"
    elif ((rank[${included%%/*}] > rank[${file%%/*}])); then
      complain "$file:$line: ${file%%/*} may not include ${included%%/*}"
    elif [[ ! -f $included ]]; then
      complain "$file:$line: \"$included\" does not exist"
    fi
  done < <(sources | xargs grep -Hn '^ *# *include *"')
}

# A file is short enough, or tests/house/long_files.txt says why it is not.
check_length() {
  local file lines listed
  listed=" $(sed -e 's/#.*//' -e '/^ *$/d' tests/house/long_files.txt | tr -s ' \n' '  ') "
  while read -r lines file; do
    [[ $file == total ]] && continue
    if ((lines > longest_file)) && [[ $listed != *" $file "* ]]; then
      complain "$file: $lines lines, more than $longest_file"
    elif ((lines <= longest_file)) && [[ $listed == *" $file "* ]]; then
      complain "tests/house/long_files.txt: $file is short by now ($lines lines)"
    fi
  done < <({ sources; find "${rooms[@]}" tests -name '*.glsl'; echo bootstrap; } | xargs wc -l)
  for file in $listed; do
    [[ -f $file ]] || complain "tests/house/long_files.txt: $file does not exist"
  done
}

# Formatting differs between versions of clang-format, so only the one that the tree is written with can tell.
check_format() {
  local tool
  tool="$(command -v clang-format-14 || command -v clang-format || true)"
  [[ -n $tool ]] || skip "clang-format is not installed"
  [[ $("$tool" --version) == *"version 14."* ]] || skip "clang-format is not version 14"
  sources | xargs "$tool" --dry-run -Werror || broken=1
}

check_presets() {
  local listed preset
  listed="$(cmake --list-presets=all)" || complain "CMakePresets.json does not parse"
  for preset in release debug asan; do
    [[ $(grep -c "\"$preset\"" <<<"$listed") -eq 3 ]] || complain "preset $preset does not configure, build and test"
  done
}

check_headers() {
  local file
  for file in $(sources | grep '\.hpp$'); do
    grep -q '^#pragma once$' "$file" || complain "$file: no #pragma once"
  done
}

check_scripts() {
  local script
  for script in bootstrap .ci/run tests/house/check.sh; do
    bash -n "$script" || complain "$script does not parse"
    [[ -x $script ]] || complain "$script is not executable"
  done
  command -v shellcheck >/dev/null || skip "shellcheck is not installed"
  shellcheck bootstrap .ci/run tests/house/check.sh || broken=1
}

# Every work that the tree cites by key stands in references.bib, once.
check_references() {
  local key keys
  keys="$(sed -n 's/^@[a-z]*{\([a-z0-9]*\),.*/\1/p' references.bib | sort)"
  [[ -z $(uniq -d <<<"$keys") ]] || complain "references.bib: twice: $(uniq -d <<<"$keys" | tr '\n' ' ')"
  while read -r key; do
    grep -qx "$key" <<<"$keys" || complain "references.bib has no $key"
  done < <(grep -rhoE 'references\.bib: [a-z0-9]+(, [a-z]+[0-9]{4})*' "${rooms[@]}" tests --include='*.[chg]*' --include='*.md' |
    sed 's/^references.bib: //' | tr -d ' ' | tr ',' '\n' | sort -u)
}

# Work that is put off is written in the tracker, not in the code.
check_words() {
  if grep -IrnwE 'T[O]DO|F[I]XME|X[X]X' "${rooms[@]}" tests bootstrap .ci CMakeLists.txt; then broken=1; fi
}

case "${1:-}" in
  includes) check_includes ;;
  length) check_length ;;
  format) check_format ;;
  presets) check_presets ;;
  headers) check_headers ;;
  scripts) check_scripts ;;
  references) check_references ;;
  words) check_words ;;
  *)
    printf 'usage: %s includes|length|format|presets|headers|scripts|references|words\n' "$0" >&2
    exit 2
    ;;
esac
exit "$broken"
