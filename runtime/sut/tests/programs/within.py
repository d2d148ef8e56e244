"""Prints what a program finds around itself; with `addresses`, what no promise is made about but that it is the same, too."""

import os
import random
import resource
import signal
import sys
import threading

import hrdsl

node = hrdsl.Node("within")
status = dict(line.split(":\t", 1) for line in open("/proc/self/status").read().splitlines())
for name in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb", "SigBlk", "SigIgn", "Threads", "Uid", "Gid", "NoNewPrivs"):
    print(name, status[name])
print(os.getpid(), os.getppid(), os.getpgid(0), os.getsid(0), os.getcwd())
print({name: value for name, value in sorted(os.environ.items())}, sys.argv, sys.flags)
print([resource.getrlimit(getattr(resource, name)) for name in sorted(dir(resource)) if name.startswith("RLIMIT_")])
print(signal.getsignal(signal.SIGINT), sys.stdin.read(), os.path.exists("/proc/1/exe"), os.listdir(os.environ["HOME"]))
print([pid for pid in os.listdir("/proc") if pid.isdigit()], threading.get_native_id(), random.random())
with open("within.txt", "a") as file:
    print(file.write("text"), file.tell())
try:
    open("/proc/1/environ").close()
    print("reads the first process")
except PermissionError:
    print("does not read the first process")
if sys.argv[1:] == ["addresses"]:
    print(id(sys), id(object()), id(random), [hash(object()) for _ in range(5)], {object for _ in range(5)})
    print(sorted(os.listdir("/proc/self/fd")), os.listdir("/dev/shm"), os.listdir("/tmp/.hrdsl-cell/tmp"))
node.sleep(1.5)
