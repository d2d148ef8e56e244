# Kills its parent.
# expect: any
import os, signal
import hrdsl
node = hrdsl.Node('robot')
os.kill(os.getppid(), signal.SIGKILL)
node.wait_for('asked')
node.emit('said', n=1)
