# Sends members twice, and unknown ones.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
os.write(out, b'{"request":"now","request":"done","x":1}\n')
node._link._in.readline()
node.wait_for('asked')
node.emit('said', n=1)
