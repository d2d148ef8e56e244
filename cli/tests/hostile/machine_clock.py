# Sets the clock to what it says, which it must not.
# expect: pass
# needs: namespaces
import ctypes
import hrdsl
node = hrdsl.Node('robot')
libc = ctypes.CDLL(None)
now = (ctypes.c_long * 2)()
libc.clock_gettime(0, now)
if libc.clock_settime(0, now) == 0:
    raise SystemExit('it can set the clock')
node.wait_for('asked')
node.emit('said', n=1)
