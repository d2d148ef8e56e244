"""Neither ends nor listens to signals; its coverage cannot be had."""

import ctypes
import signal

import hrdsl

signal.signal(signal.SIGTERM, signal.SIG_IGN)
node = hrdsl.Node("stubborn")
node.now()
while True:
    ctypes.CDLL(None).pause()
