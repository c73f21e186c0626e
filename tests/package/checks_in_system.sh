#!/usr/bin/env bash
# For the scripts that run in the system under test: check WHAT COMMAND..., one line each.
# shellcheck disable=SC2034 # read by the script that includes this one
failed=0
check() {
  local what=$1 said
  shift
  if said=$("$@" 2>&1); then
    printf 'ok      %s\n' "$what"
  else
    printf 'FAILED  %s\n' "$what"
    printf '%s\n' "$said" | tail -n 20 | sed 's/^/        /'
    # shellcheck disable=SC2034
    failed=1
  fi
}

# same TEXT COMMAND...: the command prints exactly this.
same() {
  local expected=$1 said
  shift
  said=$("$@") || true
  [ "$said" = "$expected" ] && return
  printf 'expected: %s\nis: %s\n' "$expected" "$said"
  return 1
}
