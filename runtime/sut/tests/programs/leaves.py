"""Leaves processes behind that try to outlive it: in its group, in a session of their own, and as an orphan's orphan."""
import os
import subprocess
import sys
import time

import hrdsl

node = hrdsl.Node("leaves")
FOREVER = [sys.executable, "-c", "import time, signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(1000)", sys.argv[1]]
subprocess.Popen(FOREVER)
subprocess.Popen(FOREVER, start_new_session=True)
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        os.execv(sys.executable, FOREVER)
    os._exit(0)
os.wait()
node.emit("left", pid=0)
node.sleep(1.0)
