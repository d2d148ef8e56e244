# Makes the file for its coverage as large as a disk.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
for fd in range(3, 20):
    try:
        if 'coverage' in os.readlink('/proc/self/fd/%d' % fd):
            os.ftruncate(fd, 3 << 30)
    except OSError:
        pass
node.wait_for('asked')
node.emit('said', n=1)
node._link.done()
os._exit(0)
