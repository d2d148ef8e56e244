# Makes and removes files among the devices, as far as it may; it answers.
# expect: pass
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
try:
    open('/dev/hrdsl-soak', 'w').close()
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
