#!/bin/sh
# Exit codes of a program with the main() of test_main.cpp. Usage: skips_check.sh PROGRAM
unset PELORUS_NO_SKIPS
expect() {
  code=$1
  tests=$2
  shift 2
  env "$@" --gtest_filter="$tests" > /dev/null
  got=$?
  [ $got = "$code" ] && return
  echo "$tests with $*: exit code $got in place of $code"
  exit 1
}
expect 0 '*Passes' "$1"
expect 77 '*Skips' "$1"
expect 77 '*Skips:*Passes' "$1"
expect 1 '*Fails:*Skips' "$1"
expect 0 '*Passes' PELORUS_NO_SKIPS=1 "$1"
expect 1 '*Skips:*Passes' PELORUS_NO_SKIPS=1 "$1"
