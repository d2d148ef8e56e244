# Closes its output; it answers.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
os.close(1)
os.close(2)
node.wait_for('asked')
node.emit('said', n=1)
