# A chain of processes that fork and end, so that none is there for long; it answers.
# expect: pass
# needs: namespaces
import os, posix, time
import hrdsl
node = hrdsl.Node('robot')
if posix.fork() == 0:
    for _ in range(3000):
        if posix.fork():
            os._exit(0)
    os._exit(0)
node.wait_for('asked')
node.emit('said', n=1)
