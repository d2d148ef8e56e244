# Removes its own folder; it answers.
# expect: pass
import os, shutil
import hrdsl
node = hrdsl.Node('robot')
shutil.rmtree(os.getcwd(), ignore_errors=True)
node.wait_for('asked')
node.emit('said', n=1)
