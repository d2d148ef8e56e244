"""Neither ends nor listens to signals; its coverage cannot be had."""

import signal

import hrdsl

signal.signal(signal.SIGTERM, signal.SIG_IGN)
node = hrdsl.Node("stubborn")
node.now()
while True:
    signal.pause()
