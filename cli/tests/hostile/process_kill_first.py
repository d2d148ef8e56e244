# Kills the first process.
# expect: pass
# needs: namespaces
import os, signal
import hrdsl
node = hrdsl.Node('robot')
try:
    os.kill(1, signal.SIGKILL)
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
