# Ten children fill their memory; it answers all the same.
# expect: pass
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
for _ in range(10):
    if posix.fork() == 0:
        try:
            bytearray(30 << 20)
        finally:
            os._exit(0)
for _ in range(10):
    os.wait()
node.wait_for('asked')
node.emit('said', n=1)
