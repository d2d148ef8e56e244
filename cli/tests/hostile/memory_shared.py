# Fills the shared memory; it answers all the same.
# expect: pass
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
try:
    with open('/dev/shm/full', 'wb') as file:
        while True:
            file.write(bytes(1 << 20))
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
