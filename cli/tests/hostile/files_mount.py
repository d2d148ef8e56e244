# Mounts and unmounts, as far as it may; it answers.
# expect: pass
# needs: namespaces
import os, subprocess
import hrdsl
node = hrdsl.Node('robot')
subprocess.run(['mount', '-t', 'tmpfs', 'x', '/tmp'])
subprocess.run(['umount', '-l', os.getcwd()])
node.wait_for('asked')
node.emit('said', n=1)
