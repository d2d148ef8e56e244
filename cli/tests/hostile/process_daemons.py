# Leaves fifty daemons, twice forked; it answers.
# expect: pass
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
for _ in range(50):
    if posix.fork() == 0:
        if posix.fork() == 0:
            os.setsid()
            os.execvp('sleep', ['sleep', '1000'])
        os._exit(0)
node.wait_for('asked')
node.emit('said', n=1)
