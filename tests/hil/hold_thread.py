#!/usr/bin/env python3
"""Holds one thread of a process still while its others go on, as a thread that hangs, until the process ends.
Says "held" when it does.

usage: hold_thread.py PID NAME_OF_THREAD
Exit code 0 when the process ended, 1 when there is no such thread or it may not be held.
"""

import ctypes
import glob
import os
import sys

PTRACE_SEIZE, PTRACE_INTERRUPT, WALL = 0x4206, 0x4207, 0x40000000


def thread_named(pid, name):
    for path in glob.glob(f"/proc/{pid}/task/*/comm"):
        with open(path, encoding="ascii") as comm:
            if comm.read().strip() == name:
                return int(path.split("/")[4])
    return None


def hold(pid, name):
    thread = thread_named(pid, name)
    if thread is None:
        print(f"process {pid} has no thread {name}")
        return 1
    libc = ctypes.CDLL(None, use_errno=True)
    for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
        if libc.ptrace(request, thread, None, None) != 0:
            print(f"thread {name} cannot be held: {os.strerror(ctypes.get_errno())}")
            return 1
    os.waitpid(thread, WALL)
    print("held", flush=True)
    # Reaps the thread as well, without which its process would stay in the table.
    while os.WIFSTOPPED(os.waitpid(thread, WALL)[1]):
        pass
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(hold(int(sys.argv[1]), sys.argv[2]))
