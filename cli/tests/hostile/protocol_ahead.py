# Asks a thousand things before it reads the first reply.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
for _ in range(1000):
    os.write(out, b'{"request":"now"}\n')
for _ in range(1000):
    node._link._in.readline()
node.wait_for('asked')
node.emit('said', n=1)
