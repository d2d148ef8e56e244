# Lets a child speak in its place, half lines among others.
# expect: any
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
fd = node._link._out
if posix.fork() == 0:
    for _ in range(100):
        os.write(fd, b'{"request":"now"}\n{"requ')
    os._exit(0)
node.wait_for('asked')
node.emit('said', n=1)
