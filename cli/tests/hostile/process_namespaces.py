# Enters namespaces of its own and leaves a process there; it answers.
# expect: pass
# needs: namespaces
import ctypes, os, posix
import hrdsl
node = hrdsl.Node('robot')
libc = ctypes.CDLL(None)
libc.unshare(0x10000000 | 0x20000000 | 0x20000)
if posix.fork() == 0:
    os.execvp('sleep', ['sleep', '1000'])
node.wait_for('asked')
node.emit('said', n=1)
