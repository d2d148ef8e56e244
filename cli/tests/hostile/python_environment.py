# Clears its environment; it answers.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
os.environ.clear()
node.wait_for('asked')
node.emit('said', n=1)
