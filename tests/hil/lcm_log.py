"""Reads the log of lcm-logger and the fields of Pelorus' messages (services/messages) that the checks need."""

import struct

STATES = ["INIT", "TRACKING", "DEGRADED", "LOST", "CAMERA_FAULT", "CALIBRATION_FAULT", "STANDBY"]
EVENT = struct.Struct(">Iqqii")  # sync word, number, time of reception [us], lengths of channel and data
ODOM = struct.Struct(">QqqdBqb")  # hash, utime, publish_utime, latency_ms, deadline_missed, seq, state
POSE = struct.Struct(">Bbidii3d4d36d")  # pose_valid, quality, resets, confidence, points, position, (w, x, y, z), covariance
VELOCITY = struct.Struct(">B3d")  # velocity_valid, vel_body_mps
TRACK = struct.Struct(">Bi3d4d36d3d4d36dB3d3d3d3dd3d2qi")  # what follows phase_text, up to n_outline
HEALTH_COUNTERS = ("pairs_captured results_published deadline_misses dropped_in_source dropped_ring_full "
                   "dropped_superseded dropped_unpaired results_dropped camera_timeouts frozen_spells steps_shed time_jumps "
                   "losses_of_track lcm_errors lcm_reconnects previews_skipped pictures_incomplete packets_missing "
                   "packets_resent camera_reopens can_sets_sent can_sets_dropped can_sets_unheard can_error_frames "
                   "can_bus_offs recorder_pairs_written recorder_pairs_dropped recorder_pairs_failed").split()
HEALTH_TEXTS = "recorder_text can_text privileges_text".split()


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
    velocity = VELOCITY.unpack_from(data, offset + POSE.size)
    return {"utime": utime, "publish_utime": publish_utime, "latency_ms": latency_ms, "late": bool(deadline_missed),
            "seq": seq, "state": STATES[state], "reason": reason, "valid": bool(pose[0]), "quality": pose[1],
            "resets": pose[2], "points": pose[4], "position": pose[6:9], "quaternion": pose[9:13],
            "variances": pose[13:49:7], "velocity": velocity[1:] if velocity[0] else None}


def tracks(data):
    """The bodies of one pair: its time, and of each body by its id where it is."""
    (utime,) = struct.unpack_from(">q", data, 8)
    _, offset = text(data, 8 + 3 * 8 + 1)
    _, _, count = struct.unpack_from(">dii", data, offset)
    offset += 16
    bodies = {}
    for _ in range(count):
        (ident,) = struct.unpack_from(">i", data, offset)
        phase, offset = text(data, offset + 5)
        fields = TRACK.unpack_from(data, offset)
        bodies[ident] = {"phase": phase, "position": fields[2:5], "quaternion": fields[5:9], "variances": fields[9:45:7]}
        offset += TRACK.size + 8 * fields[-1]
    return {"utime": utime, "bodies": bodies}


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
    offset += 10 * 8
    for name in HEALTH_TEXTS:
        counters[name], offset = text(data, offset)
    return counters


def results_and_reports(path):
    """What the log holds of VIS_ODOM, each with when it was received [us], and of VIS_HEALTH."""
    results, reports = [], []
    for received_us, channel, data in events(path):
        if channel.endswith(".VIS_ODOM"):
            results.append({**odom(data), "received": received_us})
        elif channel.endswith(".VIS_HEALTH"):
            reports.append(health(data))
    return results, reports
