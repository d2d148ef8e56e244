# Puts a link in the place of its own folder, as far as it may; it answers.
# expect: pass
# needs: namespaces
# options: --keep-files
import os
import hrdsl
node = hrdsl.Node('robot')
here = os.getcwd()
try:
    os.rename(here, here + '-moved')
    os.symlink('/', here)
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
