# Leaves a daemon that floods.
# expect: any
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
if posix.fork() == 0:
    os.setsid()
    while True:
        os.write(1, b'x' * 4096)
node.wait_for('asked')
node.emit('said', n=1)
