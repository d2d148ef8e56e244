# Writes every byte there is; it answers.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
os.write(1, bytes(range(256)) * 20)
os.write(2, bytes(range(255, -1, -1)) * 20)
node.wait_for('asked')
node.emit('said', n=1)
