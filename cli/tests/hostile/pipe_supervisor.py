# Looks for the descriptors of its parent, and writes into what it can open.
# expect: pass
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
try:
    for fd in os.listdir('/proc/%d/fd' % os.getppid()):
        place = '/proc/%d/fd/%s' % (os.getppid(), fd)
        if os.path.isdir(place):
            raise SystemExit('a folder of another: %s' % os.readlink(place))
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
