# Sends members twice, and unknown ones.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
replies = open(node._link._in, 'rb', buffering=0, closefd=False)
out = node._link._out
os.write(out, b'{"request":"now","request":"done","x":1}\n')
replies.readline()
node.wait_for('asked')
node.emit('said', n=1)
