# Goes on asking after it is done.
# expect: any
import os
import hrdsl
node = hrdsl.Node('robot')
out = node._link._out
node.wait_for('asked')
node.emit('said', n=1)
node._link.done()
while True:
    os.write(out, b'{"request":"now"}\n')
