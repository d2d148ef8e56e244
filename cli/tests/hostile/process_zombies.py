# Waits for none of its hundred children; it answers.
# expect: pass
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
for _ in range(100):
    if posix.fork() == 0:
        os._exit(0)
node.wait_for('asked')
node.emit('said', n=1)
