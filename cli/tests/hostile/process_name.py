# Calls itself what confuses readers of /proc.
# expect: pass
import ctypes, os, posix
import hrdsl
node = hrdsl.Node('robot')
ctypes.CDLL(None).prctl(15, b') R 1 (\n')
if posix.fork() == 0:
    os.execvp('sleep', ['sleep', '1000'])
node.wait_for('asked')
node.emit('said', n=1)
