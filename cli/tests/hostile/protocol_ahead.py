# Asks a thousand things before it reads the first reply.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
for _ in range(1000):
    os.write(out, b'{"request":"now"}\n')
for _ in range(1000):
    replies.readline()
node.wait_for('asked')
node.emit('said', n=1)
