"""Reaches for what is not its own."""

import ctypes
import os
import signal
import subprocess
import sys

import hrdsl

node = hrdsl.Node("reaches")


def succeeds(action):
    try:
        return bool(action())
    except OSError:
        return False


def set_clock():
    now = (ctypes.c_long * 2)()
    libc = ctypes.CDLL(None)
    libc.clock_gettime(0, now)
    return libc.clock_settime(0, now) == 0


def write(path, text):
    with open(path, "w") as file:
        return file.write(text)


def change_setting():
    path = "/proc/sys/vm/swappiness"
    with open(path) as file:
        return write(path, file.read())


def make_device():
    path = "/dev/hrdsl-reaches"
    return write(path, "x") and not os.remove(path)


def enter_supervisor():
    folder = "/proc/%d/fd" % os.getppid()
    return any(os.path.isdir(os.path.join(folder, name)) for name in os.listdir(folder))


if sys.argv[1] == "parent":
    subprocess.Popen(["sleep", "1000"])
    subprocess.Popen([sys.executable, "-c", "import select; select.select([], [], [], 1000)", sys.argv[2]])
    os.kill(os.getppid(), getattr(signal, sys.argv[3]))
    while True:
        pass
print([succeeds(action) for action in (set_clock, change_setting, make_device, enter_supervisor)])
