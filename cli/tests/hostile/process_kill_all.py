# Kills all that it may.
# expect: any
# needs: namespaces
import os, signal
import hrdsl
node = hrdsl.Node('robot')
os.kill(-1, signal.SIGKILL)
node.wait_for('asked')
node.emit('said', n=1)
