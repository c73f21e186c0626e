#!/usr/bin/env python3
"""pelorus.dbc read by a decoder that is not ours (canmatrix), on frames of the published test vectors.

canmatrix skips what it does not understand and lets signals overlap, so those are checked here first. The values it
decodes are compared with the vectors' own (docs/can.md lists them). Exit code 77: canmatrix is not installed.
usage: dbc_test.py SOURCE_ROOT
"""

import contextlib
import io
import logging
import math
import os
import re
import struct
import sys
import warnings

try:
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)  # formats it could read with more packages
    import canmatrix.formats
except ImportError:
    print("skipped: python3-canmatrix is not installed")
    sys.exit(77)

ROOT = sys.argv[1]
RECEIVER = os.path.join(ROOT, "firmware-host", "autopilot")
INVALID = "-"
failures = []


def check(condition, message):
    if not condition:
        failures.append(message)


def load():
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        matrix = canmatrix.formats.loadp_flat(os.path.join(RECEIVER, "pelorus.dbc"))
    check(said.getvalue() == "", f"canmatrix complains: {said.getvalue()}")
    return matrix


def check_layout(matrix):
    """What canmatrix itself would let pass."""
    with open(os.path.join(RECEIVER, "pelorus.dbc"), encoding="utf-8") as dbc:
        text = dbc.read()
    declared = len(re.findall(r"^ SG_ ", text, re.M))
    check(declared == sum(len(frame.signals) for frame in matrix.frames), "a signal line was skipped")
    check(len(re.findall(r"^BO_ ", text, re.M)) == len(matrix.frames), "a frame line was skipped")
    for frame in matrix.frames:
        taken = set()
        for signal in frame.signals:
            bits = set(range(signal.get_startbit(), signal.get_startbit() + signal.size))
            check(signal.is_little_endian, f"{frame.name}.{signal.name} is not Intel")
            check(not bits & taken, f"{frame.name}.{signal.name} overlaps")
            check(max(bits) < 8 * frame.size, f"{frame.name}.{signal.name} leaves the frame")
            check(signal.comment, f"{frame.name}.{signal.name} has no comment")
            taken |= bits
        check(frame.is_fd == frame.name.startswith("VIS_FD"), f"{frame.name}: wrong frame format")


def published_vectors():
    """(frame name, bytes, {signal: text}) of every row of the tables of vectors."""
    with open(os.path.join(ROOT, "docs", "can.md"), encoding="utf-8") as page:
        for line in page:
            match = re.match(r"\| (VIS_\w+) \| `([0-9A-F]+)` \| (.*) \|$", line)
            if match:
                words = match.group(3).split()
                yield match.group(1), bytes.fromhex(match.group(2)), dict(zip(words[::2], words[1::2]))


def frames_of_log(name):
    with open(os.path.join(RECEIVER, name), encoding="utf-8") as log:
        for line in log:
            ident, payload = re.match(r"\([\d.]+\) can0 ([0-9A-F]{3})#(?:#0)?([0-9A-F]+)$", line).groups()
            yield int(ident, 16), bytes.fromhex(payload)


def expected_of(signal, raw, comment):
    """Physical value of a raw one, for the codings DBC cannot express."""
    log = re.search(r"uint8, (\S+) \S+ \* 2\^\(raw/16\)", comment)
    if log:
        return math.nan if raw == 255 else float(log.group(1)) * 2 ** (raw / 16)
    if "binary16" in comment:
        return struct.unpack("<e", struct.pack("<H", raw))[0]
    return None


def close(a, b):
    if math.isnan(a) or math.isnan(b) or math.isinf(a):
        return (math.isnan(a) and math.isnan(b)) or a == b
    return abs(a - b) <= 1e-6 * max(1.0, abs(a), abs(b))


def check_value(name, signal, decoded, text):
    raw = decoded.raw_value
    physical = float(decoded.phys_value)
    special = expected_of(signal, raw, signal.comment)
    if special is not None:
        physical = special
    elif signal.values.get(raw) == "INVALID":
        physical = math.nan
    want = math.nan if text == INVALID else float(text)
    check(close(want, physical), f"{name}.{signal.name}: canmatrix reads {physical}, published {text}")


def main():
    logging.disable(logging.NOTSET)
    matrix = load()
    check_layout(matrix)
    compared = 0
    rows = list(published_vectors())
    for name, payload, values in rows:
        frame = matrix.frame_by_name(name)
        decoded = frame.decode(payload)
        for signal in frame.signals:
            if signal.name in ("CRC", "COUNTER", "STATE"):
                continue
            check(signal.name in values, f"{name}.{signal.name} is not published")
            check_value(name, signal, decoded[signal.name], values.get(signal.name, INVALID))
            compared += 1
    logged = list(frames_of_log("vectors_classic.log")) + list(frames_of_log("vectors_fd.log"))
    check([payload for _, payload in logged] == [payload for _, payload, _ in rows],
          "the logs are not the published vectors")
    for (ident, _), (name, _, _) in zip(logged, rows):
        check(matrix.frame_by_name(name).arbitration_id.id == ident, f"{name} has another identifier in the log")
    check(compared > 200, f"only {compared} values compared")
    for failure in failures:
        print(failure)
    print(f"dbc_test: {compared} values of {len(rows)} frames, {len(failures)} failure(s)")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
