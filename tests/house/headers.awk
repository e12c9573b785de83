# Prints `file:line: name needs <header>` for every name of standard_names.txt that a file uses without including a header that
# gives it. Usage: awk -f headers.awk standard_names.txt FILE...

# The headers in angle brackets that the file includes, into the array `into`.
function read_includes(file, into,    line) {
  while ((getline line < file) > 0) {
    if (match(line, /^ *# *include *<[^>]*>/)) {
      sub(/^[^<]*</, "", line)
      sub(/>.*/, "", line)
      into[line] = 1
    }
  }
  close(file)
}

function check(name, place,    i, count, choices) {
  if (name in seen) return
  seen[name] = 1
  if (!(name in headers)) {
    if (name ~ /^std::/) print place ": tests/house/standard_names.txt does not know " name
    return
  }
  count = split(headers[name], choices, " ")
  for (i = 1; i <= count; i++) if (choices[i] in included) return
  print place ": " name " needs <" choices[1] ">"
}

FILENAME == ARGV[1] {
  if ($0 ~ /^#/ || NF < 2) next
  name = $1
  $1 = ""
  headers[name] = $0
  next
}

FNR == 1 {
  split("", included)
  split("", seen)
  read_includes(FILENAME, included)
  own = FILENAME
  if (sub(/\.cpp$/, ".hpp", own)) read_includes(own, included)
}

{
  line = $0
  gsub(/\\./, "", line)
  gsub(/"[^"]*"/, "\"\"", line)
  sub(/\/\/.*/, "", line)
  place = FILENAME ":" FNR
  if (line ~ /(^|[^_a-zA-Z])assert\(/) check("assert(", place)
  if (line ~ /(^|[^_a-zA-Z])errno([^_a-zA-Z]|$)/) check("errno", place)
  while (match(line, /(^|[^_a-zA-Z0-9:])std::[_a-zA-Z0-9]+/)) {
    name = substr(line, RSTART, RLENGTH)
    sub(/^.*std::/, "std::", name)
    check(name, place)
    line = substr(line, RSTART + RLENGTH)
  }
}
