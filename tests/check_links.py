#!/usr/bin/env python3
"""Links of the documents: every relative link and picture in a *.md file leads to a file, every #part to a heading.

Usage: check_links.py [ROOT]. Prints one line per dangling link and exits 1 when there is any. Links may not leave ROOT,
which is the project or a folder of installed documents.
"""

import os
import re
import sys

from tree_check import run_check

SKIPPED_FOLDERS = {".git", "build", "out", "node_modules"}
LINK = re.compile(r"\]\(\s*<?([^()\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
REFERENCE = re.compile(r"^\s{0,3}\[[^\]]+\]:\s*<?(\S+?)>?\s*$")
FOREIGN = re.compile(r"^[a-zA-Z][a-zA-Z0-9+.-]*:")  # https:, mailto:


def documents(root):
    for folder, names, files in os.walk(root):
        names[:] = sorted(name for name in names if name not in SKIPPED_FOLDERS and not name.startswith("build-"))
        for name in sorted(files):
            if name.endswith(".md"):
                yield os.path.relpath(os.path.join(folder, name), root)


def prose(path):
    """The lines outside of fenced and indented blocks, without `code`; blocks are blank, so that numbers stay right."""
    fenced = False
    before_is_text = False
    with open(path, encoding="utf-8") as document:
        for line in document:
            if line.lstrip().startswith(("```", "~~~")):
                fenced = not fenced
                line = ""
            indented = line.startswith(("    ", "\t")) and not before_is_text
            before_is_text = bool(line.strip()) and not indented
            yield "" if fenced or indented else re.sub(r"`[^`]*`", lambda code: "." * len(code.group()), line)


def links(path):
    for number, line in enumerate(prose(path), start=1):
        for pattern in (LINK, REFERENCE):
            for match in pattern.finditer(line):
                yield number, match.group(1)


def anchors(path):
    """Names of the headings, as the common renderers make them: words in lower case, joined by hyphens."""
    found = {}
    names = set()
    with open(path, encoding="utf-8") as document:
        for line in document:
            heading = re.match(r"#{1,6}\s+(.*?)\s*#*\s*$", line)
            if not heading:
                continue
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
            name = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            count = found[name] = found.get(name, -1) + 1
            names.add(name if count == 0 else f"{name}-{count}")
    return names


def problem_with(root, document, target):
    path, _, part = target.partition("#")
    here = os.path.join(root, document)
    there = os.path.normpath(os.path.join(os.path.dirname(here), path)) if path else here
    if os.path.isabs(path) or os.path.relpath(there, root).startswith(".."):
        return "leads out of the tree"
    if not os.path.exists(there):
        return "leads to nothing"
    if part and there.endswith(".md") and part not in anchors(there):
        return "names no heading there"
    return None


def violations(root):
    for document in documents(root):
        for number, target in links(os.path.join(root, document)):
            problem = None if FOREIGN.match(target) else problem_with(root, document, target)
            if problem:
                yield f"{document}:{number}: {target} {problem}"


def main(arguments):
    return run_check(arguments, "check_links", documents, violations, "documents", "dangling link(s)")


if __name__ == "__main__":
    sys.exit(main(sys.argv))
