"""Uses more of something than it may."""
import ctypes
import os
import signal
import sys

import hrdsl

node = hrdsl.Node("uses")
what = sys.argv[1]
if what == "cpu":
    while True:
        pass
elif what == "cpu-between-requests":
    while True:
        sum(range(100000))
        node.sleep(0.01)
elif what == "sleep":
    ctypes.CDLL(None).pause()  # past what is simulated
elif what == "memory":
    node.now()
    taken = []
    try:
        while True:
            taken.append(bytearray(1 << 20))
    except MemoryError:
        count = len(taken)
        del taken
        print("memory error after", count)
elif what == "output":
    while True:
        print("x" * 1000)
elif what == "children":
    os.system("true")
elif what == "environment":
    print(sorted(os.environ))
elif what == "signals":
    print(signal.pthread_sigmask(signal.SIG_BLOCK, []), signal.getsignal(signal.SIGCHLD), signal.getsignal(signal.SIGPIPE))
elif what == "addresses":
    print(id(object()), hash(None), [hash(object()) for _ in range(3)], id(sys))
