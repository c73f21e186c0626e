"""What the checks of the source tree share: where the tree is, what is printed and the exit code."""

import os
import sys


def run_check(arguments, name, subjects, violations, what, complaint):
    """Prints the violations of the tree in arguments[1] (default: this project); 1 when there is any, or no subject.

    subjects(root) and violations(root) are generators; `what` names the subjects, `complaint` the violations.
    """
    root = arguments[1] if len(arguments) > 1 else os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    checked = sum(1 for _ in subjects(root))
    if checked == 0:
        print(f"{root}: none of the {what} found", file=sys.stderr)
        return 1
    found = list(violations(root))
    for violation in found:
        print(violation)
    print(f"{name}: {checked} {what}, {len(found)} {complaint}")
    return 1 if found else 0
