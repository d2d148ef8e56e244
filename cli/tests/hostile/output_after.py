# Floods after it is done.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
node.emit('said', n=1)
node._link.done()
while True:
    os.write(1, b'x' * 4096)
