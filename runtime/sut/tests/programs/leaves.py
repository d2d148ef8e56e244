"""Leaves processes behind that try to outlive it: in its group, in a session of their own, and as an orphan's orphan."""
import os
import posix
import sys

import hrdsl

node = hrdsl.Node("leaves")
FOREVER = [sys.executable, "-c", "import time, signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(1000)", sys.argv[1]]
if posix.fork() == 0:
    os.execv(sys.executable, FOREVER)
if posix.fork() == 0:
    os.setsid()
    os.execv(sys.executable, FOREVER)
child = posix.fork()
if child == 0:
    os.setsid()
    if posix.fork() == 0:
        os.execv(sys.executable, FOREVER)
    os._exit(0)
os.waitpid(child, 0)
node.emit("left", pid=0)
node.sleep(1.0)
