# What the scripts of the host stages share; to be sourced. Needs $work, a directory of their own.
# shellcheck shell=bash
passed=0 failed=0 skipped=0
export LC_ALL=C.UTF-8

# check NAME COMMAND...: one check; what the command says is shown when it fails.
check() {
  local name=$1
  shift
  if "$@" >"$work/out" 2>&1; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED: $name"
    sed 's/^/    /' "$work/out" | tail -n 40
    return 1
  fi
}

# suite NAME PROGRAM...: a test program, whose own checks are counted. It must end with its count,
# and exit with 1 if one failed.
suite() {
  local name=$1 out=$work/$1.out code=0 last
  shift
  "$@" >"$out" 2>&1 || code=$?
  last=$(tail -n 1 "$out")
  if [[ $last =~ ^([0-9]+)\ passed,\ ([0-9]+)\ failed$ ]] && [ "${BASH_REMATCH[1]}" -gt 0 ]; then
    passed=$((passed + BASH_REMATCH[1]))
    failed=$((failed + BASH_REMATCH[2]))
    [ "${BASH_REMATCH[2]}" = 0 ] || grep FAILED "$out" | head -n 20
    check "$name: exit code $code" test "$code" -eq "$((BASH_REMATCH[2] > 0))"
    echo "  $name: $last"
  else
    failed=$((failed + 1))
    echo "FAILED: $name ended with code $code and without a count"
    tail -n 20 "$out"
  fi
}

# skip N WHY: N checks that cannot be made here.
skip() {
  skipped=$((skipped + $1))
  echo "skipped: $2"
}

finish() {
  echo "$passed passed, $failed failed, $skipped skipped"
  [ "$failed" -eq 0 ]
  exit
}

same() { test "$1" = "$2" || { echo "is '$1', should be '$2'"; return 1; }; }

# The libraries of the command line's release build, installed below $1.
install_libraries() {
  cargo build --release && bash "$root/bindings/install.sh" "$1" --from "$target/release"
}
