#!/usr/bin/env bash
# The house's own rules, one a verb: `check.sh VERB` from anywhere; status 0 kept, 1 broken (each break on a line), 77 cannot tell.
set -euo pipefail
set -f  # `*/` stands for itself
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

readonly rooms=(gl algorithms sweeps plots sandbox)  # each may include itself and those before it
readonly longest_file=450
readonly largest_room=16
readonly scripts=(bootstrap .ci/run tests/house/check.sh tests/house/mend_headers tests/release/debian.sh)
broken=0

complain() {
  printf '%s\n' "$*"
  broken=1
}

die() {
  printf 'check.sh: %s\n' "$*" >&2
  kill -s TERM "$$"
  exit 1
}

skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}

# Lists of files, one a line. An empty one means that the tree is not where it should be, and a check over nothing proves nothing.
listed() {
  local found
  found="$("$@" | sort)" || die "cannot list files: $*"
  [[ -n $found ]] || die "nothing found: $*"
  printf '%s\n' "$found"
}
sources() { listed find "${rooms[@]}" tests -type f \( -name '*.cpp' -o -name '*.hpp' \); }
shaders() { listed find "${rooms[@]}" tests -type f -name '*.glsl'; }

# The order in which includes run in a room, as one line of its README states it, an entry a line: a file without its ending, a
# folder with a slash at its end, `*/` for every other folder, or several that know each other.
# "Includes run one way: `a`, `b` with `c`, `d/`, `*/`."
order_of() {
  sed -n 's/^Includes run one way: \(.*\)\.$/\1/p' "$1/README.md" | sed 's/ with /+/g' | tr -d '\140 ' | tr ',' '\n'
}

# The part of the room that the file stands in.
part_of() {
  local rest="${2#"$1"/}"
  if [[ $rest == */* ]]; then printf '%s/' "${rest%%/*}"; else printf '%s' "${rest%%.*}"; fi
}

# Includes run one way only: between rooms, and between the parts of a room that states an order.
check_includes() {
  local -A rank=([tests]=${#rooms[@]}) part_rank=()  # tests see everything, and nothing sees them
  local i file included line found from to part entry low high
  for i in "${!rooms[@]}"; do rank[${rooms[$i]}]=$i; done
  local ordered=()
  for file in $(listed find "${rooms[@]}" -name README.md); do
    [[ -n $(order_of "${file%/README.md}") ]] || continue
    ordered+=("${file%/README.md}")
    i=0
    for entry in $(order_of "${file%/README.md}"); do
      i=$((i + 1))
      for part in ${entry//+/ }; do part_rank["${file%/README.md}:$part"]=$i; done
    done
  done
  for i in "${rooms[@]}"; do
    [[ " ${ordered[*]} " == *" $i "* ]] || complain "$i/README.md states no order (\"Includes run one way: ...\")"
  done
  found="$({ sources; shaders; } | xargs grep -Hn '^ *# *include *"')" || die "no file includes anything"
  while IFS=: read -r file line included; do
    included="${included#*\"}"
    included="${included%%\"*}"
    if [[ $included != */* || ! -v rank[${included%%/*}] ]]; then
      complain "$file:$line: \"$included\" is not given from the root"
    elif ((rank[${included%%/*}] > rank[${file%%/*}])); then
      complain "$file:$line: ${file%%/*} may not include ${included%%/*}"
    elif [[ ! -f $included && ! -f tests/template/${included#algorithms/} ]]; then  # the template is included as when it is copied
      complain "$file:$line: \"$included\" does not exist"
    else
      for i in "${ordered[@]}"; do
        [[ $file == "$i"/* && $included == "$i"/* ]] || continue
        from="$(part_of "$i" "$file")"
        to="$(part_of "$i" "$included")"
        [[ $from != "$to" ]] || continue
        low="${part_rank["$i:$to"]:-}"
        high="${part_rank["$i:$from"]:-}"
        [[ -n $low || $to != */ ]] || low="${part_rank["$i:*/"]:-}"
        [[ -n $high || $from != */ ]] || high="${part_rank["$i:*/"]:-}"
        if [[ -z $low || -z $high ]]; then
          complain "$i/README.md: the order of includes lacks $from or $to"
        elif ((low > high || (low == high && high == ${part_rank["$i:*/"]:--1}))); then
          complain "$file:$line: in $i, $from may not include $to (README.md states the order)"
        fi
      done
    fi
  done <<<"$found"
}

# A room is small enough for a newcomer: a header and its .cpp count once, and so does a shader's. Each room says what lies where.
check_rooms() {
  local folder names count found
  found="$({ sources; shaders; } | grep -v '^tests/' | xargs -n 1 dirname | sort -u)" || die "no rooms"
  for folder in $found; do
    names="$(find "$folder" -maxdepth 1 \( -name '*.cpp' -o -name '*.hpp' \) -printf '%f\n' | sed 's/\..*//' | sort -u)"
    count="$(grep -c . <<<"$names" || true)"
    ((count <= largest_room)) || complain "$folder: $count files, more than $largest_room (a pair counts once)"
    [[ -f $folder/README.md || -f ${folder%/*}/README.md ]] || complain "neither $folder nor the room around it has a README.md"
  done
}

# A file is short enough, or tests/house/long_files.txt says why it is not.
# A paper is data: no code above its folder knows its name.
check_papers() {
  local folder paper
  for folder in $(listed find algorithms -mindepth 2 -maxdepth 2 -name paper.toml -printf '%h\n'); do
    paper="${folder#algorithms/}"
    while IFS= read -r line; do
      [[ -z $line ]] || complain "$line: the paper ${paper} is named outside of its folder"
    done < <(grep -rn --include='*.cpp' --include='*.hpp' --include='*.glsl' --include='CMakeLists.txt' -e "$paper" sweeps plots sandbox |
      cut -d: -f1,2 || true)
  done
}

check_length() {
  local file lines listed counted
  listed=" $(sed -e 's/#.*//' -e '/^ *$/d' tests/house/long_files.txt | tr -s ' \n' '  ') "
  counted="$({ sources; shaders; echo bootstrap; } | xargs wc -l)" || die "wc failed"
  while read -r lines file; do
    [[ $file == total ]] && continue
    if ((lines > longest_file)) && [[ $listed != *" $file "* ]]; then
      complain "$file: $lines lines, more than $longest_file"
    elif ((lines <= longest_file)) && [[ $listed == *" $file "* ]]; then
      complain "tests/house/long_files.txt: $file is short by now ($lines lines)"
    fi
  done <<<"$counted"
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

# A file includes the standard headers of the names that it uses: a newer library drags others in.
check_standard_headers() {
  local missing
  missing="$(sources | xargs awk -f tests/house/headers.awk tests/house/standard_names.txt)" || complain "headers.awk failed"
  [[ -z $missing ]] || complain "$missing"$'\n'"(tests/house/mend_headers adds them)"
}

check_headers() {
  local file files
  files="$(sources | grep '\.hpp$')" || die "no headers"
  while read -r file; do
    grep -q '^#pragma once$' "$file" || complain "$file: no #pragma once"
  done <<<"$files"
}

check_scripts() {
  local script
  for script in "${scripts[@]}"; do
    bash -n "$script" || complain "$script does not parse"
    [[ -x $script ]] || complain "$script is not executable"
  done
  command -v shellcheck >/dev/null || skip "shellcheck is not installed"
  shellcheck "${scripts[@]}" || broken=1
}

# Every work that the tree cites by key stands in references.bib, once. A key is a name and a year wherever it stands, or
# what follows "references.bib:".
check_references() {
  local key keys cited files
  keys="$(sed -n 's/^@[a-z]*{\([a-z0-9]*\),.*/\1/p' references.bib | sort)"
  [[ -n $keys ]] || die "references.bib has no entry"
  [[ -z $(uniq -d <<<"$keys") ]] || complain "references.bib: twice: $(uniq -d <<<"$keys" | tr '\n' ' ')"
  files="$(listed find "${rooms[@]}" tests README.md CONTRIBUTING.md CHANGELOG.md -type f \( -name '*.[ch]pp' -o -name '*.glsl' -o -name '*.toml' -o -name '*.md' \))"
  # shellcheck disable=SC2016  # the backquotes are Markdown's
  cited="$(xargs grep -hoE '\b[a-z]{3,}(19|20)[0-9]{2}\b|references\.bib`?: *`?[a-z0-9]+' <<<"$files" | sed 's/.*[: `]//' | sort -u)" ||
    die "nobody cites anything"
  while read -r key; do
    grep -qx "$key" <<<"$keys" || complain "references.bib has no $key, which $(xargs grep -lw "$key" <<<"$files" | head -n 1) cites"
  done <<<"$cited"
}

# Work that is put off is written in the tracker, not in the code.
check_words() {
  local status pattern
  # Left-overs, and sentences without a subject.
  for pattern in '\b(T[O]DO|F[I]XME|X[X]X)\b' '(//+|^ *#+|doc = ") *(O[f]|W[h]at) ' '(//|^ *#).*\. (O[f]|W[h]at) '; do
    status=0
    grep -IrnE "$pattern" "${rooms[@]}" tests bootstrap .ci CMakeLists.txt README.md CONTRIBUTING.md || status=$?
    case "$status" in
      0) broken=1 ;;
      1) ;;
      *) die "cannot search for words" ;;
    esac
  done
}

case "${1:-}" in
  includes) check_includes ;;
  rooms) check_rooms ;;
  papers) check_papers ;;
  length) check_length ;;
  format) check_format ;;
  presets) check_presets ;;
  headers) check_headers ;;
  standard_headers) check_standard_headers ;;
  scripts) check_scripts ;;
  references) check_references ;;
  words) check_words ;;
  *)
    printf 'usage: %s includes|rooms|length|format|presets|headers|standard_headers|scripts|references|words\n' "$0" >&2
    exit 2
    ;;
esac
exit "$broken"
