#!/usr/bin/env python3
"""Structure of the source tree: which folder may include which, what core may not use, sizes and names.

Usage: check_includes.py [ROOT]. Prints one line per violation and exits 1 when there is any. The rules are those of
ARCHITECTURE.md; a failure names the rule, so that the cure is to move the code or to change the architecture first.
"""

import os
import re
import sys

from tree_check import run_check

# Layers of core, lowest first: a folder may include itself and everything to its left.
CORE_CHAIN = ["base", "kernels", "geometry", "model", "frontend", "motion", "refine", "objects", "pipeline"]
SOURCE_FOLDERS = ["core", "drivers", "services", "firmware-host", "tests"]
ALLOWED = {
    **{f"core/{name}": {f"core/{lower}" for lower in CORE_CHAIN[: i + 1]} for i, name in enumerate(CORE_CHAIN)},
    "core/evaluation": {"core/base", "core/geometry", "core/model", "core/evaluation"},
    "drivers": {"core/base", "core/geometry", "drivers"},
    "services": {"core", "drivers", "services"},
    "firmware-host/autopilot": {"firmware-host/autopilot"},
    "firmware-host": {"core", "drivers", "services", "firmware-host"},
    "tests": {"core", "drivers", "services", "firmware-host", "tests"},
}
SOURCE_NAME = re.compile(r"\.(h|hpp|c|cc|cpp)$")
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
# Highway asks for its own headers in quotes (foreach_target.h includes the including file once per target).
QUOTED_THIRD_PARTY = ("hwy/",)
# Firmware copies these files out of the tree, so they include each other by bare name.
STAND_ALONE = "firmware-host/autopilot"
FORBIDDEN_IN_CORE = [
    (re.compile(r"#\s*include\s*<opencv"), "OpenCV in core: wrap it in drivers or firmware-host"),
    (re.compile(r"#\s*include\s*<(iostream|fstream|filesystem)>"), "core opens no file and prints nothing"),
    (re.compile(r"#\s*include\s*<(thread|mutex|shared_mutex|condition_variable|future)>"), "core starts no thread"),
    (re.compile(r"\b(std::)?(v?f?printf|puts|fputs)\s*\("), "core prints nothing"),
    (re.compile(r"\b(steady_clock|system_clock|high_resolution_clock|clock_gettime|gettimeofday)\b"),
     "core reads no clock but the stage timer"),
    (re.compile(r"\bthrow\b"), "core throws nothing: return a Result or an outcome"),
]
# The two places of core that speak to the outside world on purpose.
EXEMPT = {"core/base/check.cpp": "prints nothing", "core/base/stage_timer": "reads no clock"}
VAGUE_NAME = re.compile(r"(^|[_/-])(utils?|common|misc|helpers?)([_./-]|$)")
MAX_LINES = 300


def folder_of(path):
    """The key of ALLOWED that holds the file, or None."""
    matches = [key for key in ALLOWED if path.startswith(key + "/")]
    return max(matches, key=len, default=None)


def may_include(path, included):
    folder = folder_of(path)
    if folder is None:
        return False
    return any(included.startswith(target + "/") for target in ALLOWED[folder])


def without_comments(lines):
    """Lines with comments and string contents blanked, so that prose is free to name what code may not use."""
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), "".join(lines), flags=re.S)
    for line in text.splitlines():
        if not INCLUDE.match(line):
            line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
        yield re.sub(r"//.*", "", line)


def check_include(root, path, line):
    match = INCLUDE.match(line)
    if not match:
        return None
    quote, included = match.groups()
    if quote == "<":
        in_tree = included.split("/")[0] in SOURCE_FOLDERS and "/" in included
        return f'own headers are included in quotes: "{included}"' if in_tree else None
    if included.startswith(QUOTED_THIRD_PARTY):
        return None
    if folder_of(path) == STAND_ALONE and os.path.isfile(os.path.join(root, os.path.dirname(path), included)):
        return None
    if not os.path.isfile(os.path.join(root, included)):
        return f'"{included}" is no file of this tree (write includes from the root, third-party ones in <>)'
    if not may_include(path, included):
        return f"{folder_of(path)} may not include {included}: arrows of ARCHITECTURE.md point down only"
    return None


def check_core_line(path, line):
    for pattern, rule in FORBIDDEN_IN_CORE:
        exempt = any(path.startswith(place) and reason in rule for place, reason in EXEMPT.items())
        if pattern.search(line) and not exempt:
            return rule
    return None


def check_file(root, path):
    with open(os.path.join(root, path), encoding="utf-8", errors="replace") as source:
        lines = source.readlines()
    if len(lines) > MAX_LINES and not path.startswith("tests/"):
        yield 1, f"{len(lines)} lines: over {MAX_LINES}, a concept may be missing"
    if folder_of(path) is None:
        yield 1, "this folder has no place in the architecture (see ALLOWED in tests/check_includes.py)"
    for number, line in enumerate(without_comments(lines), start=1):
        problem = check_include(root, path, line)
        if problem is None and path.startswith("core/"):
            problem = check_core_line(path, line)
        if problem is not None:
            yield number, problem


def source_files(root):
    for top in SOURCE_FOLDERS:
        for folder, _, names in sorted(os.walk(os.path.join(root, top))):
            for name in sorted(names):
                yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def code_files(root):
    return (path for path in source_files(root) if SOURCE_NAME.search(path))


def violations(root):
    for path in source_files(root):
        if VAGUE_NAME.search(path):
            yield f"{path}:1: the name says nothing: call it after what it holds"
        if SOURCE_NAME.search(path):
            for number, problem in check_file(root, path):
                yield f"{path}:{number}: {problem}"


def main(arguments):
    return run_check(arguments, "check_includes", code_files, violations, "files", "violation(s)")


if __name__ == "__main__":
    sys.exit(main(sys.argv))
