"""Reads the log of lcm-logger and the fields of Pelorus' messages (services/messages) that the checks need."""

import struct

STATES = ["INIT", "TRACKING", "DEGRADED", "LOST", "CAMERA_FAULT", "CALIBRATION_FAULT", "STANDBY"]
EVENT = struct.Struct(">Iqqii")  # sync word, number, time of reception [us], lengths of channel and data
ODOM = struct.Struct(">QqqdBqb")  # hash, utime, publish_utime, latency_ms, deadline_missed, seq, state
POSE = struct.Struct(">Bbidii3d4d36d")  # pose_valid, quality, resets, confidence, points, position, (w, x, y, z), covariance
HEALTH_COUNTERS = ("pairs_captured results_published deadline_misses dropped_in_source dropped_ring_full "
                   "dropped_superseded dropped_unpaired results_dropped camera_timeouts frozen_spells steps_shed time_jumps "
                   "losses_of_track lcm_errors lcm_reconnects previews_skipped").split()


def events(path):
    with open(path, "rb") as log:
        while header := log.read(EVENT.size):
            if len(header) < EVENT.size:
                return  # the logger was stopped in the middle of it
            sync, _, received_us, channel_length, length = EVENT.unpack(header)
            if sync != 0xEDA1DA01:
                raise ValueError(f"{path}: not an LCM log")
            channel = log.read(channel_length).decode()
            yield received_us, channel, log.read(length)


def text(data, offset):
    (length,) = struct.unpack_from(">i", data, offset)
    return data[offset + 4 : offset + 3 + length].decode(), offset + 4 + length


def odom(data):
    _, utime, publish_utime, latency_ms, deadline_missed, seq, state = ODOM.unpack_from(data)
    _, offset = text(data, ODOM.size)
    reason, offset = text(data, offset)
    pose = POSE.unpack_from(data, offset)
    return {"utime": utime, "publish_utime": publish_utime, "latency_ms": latency_ms, "late": bool(deadline_missed),
            "seq": seq, "state": STATES[state], "reason": reason, "valid": bool(pose[0]), "position": pose[6:9],
            "quaternion": pose[9:13], "variances": pose[13:49:7]}


def health(data):
    offset = 8 + 8 + 8 + 8 + 1
    for _ in range(3):
        (length,) = struct.unpack_from(">i", data, offset)
        offset += 4 + length
    offset += 10 * 8
    counters = dict(zip(HEALTH_COUNTERS, struct.unpack_from(f">{len(HEALTH_COUNTERS)}q", data, offset)))
    offset += len(HEALTH_COUNTERS) * 8
    (counters["utime"],) = struct.unpack_from(">q", data, 8)
    (counters["sync_error_ms"],) = struct.unpack_from(">d", data, offset)
    return counters
