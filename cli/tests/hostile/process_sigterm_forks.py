# Forks whenever it is asked to end.
# expect: error "within 1 s of processor time"
# needs: namespaces
import os, posix, signal
import hrdsl
node = hrdsl.Node('robot')
signal.signal(signal.SIGTERM, lambda *_: [posix.fork() for _ in range(3)])
while True:
    pass
