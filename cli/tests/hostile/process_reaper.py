# Adopts its grandchildren and leaves them.
# expect: pass
import ctypes, os, posix
import hrdsl
node = hrdsl.Node('robot')
ctypes.CDLL(None).prctl(36, 1)
if posix.fork() == 0:
    if posix.fork() == 0:
        os.execvp('sleep', ['sleep', '1000'])
    os._exit(0)
os.wait()
node.wait_for('asked')
node.emit('said', n=1)
