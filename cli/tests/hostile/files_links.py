# Makes links out of its folder and writes through them; it answers.
# expect: pass
# options: --keep-files
import os
import hrdsl
node = hrdsl.Node('robot')
os.symlink('/tmp', 'out_of_here')
os.symlink('loop', 'loop')
os.symlink('/nowhere/at/all', 'dangling')
node.wait_for('asked')
node.emit('said', n=1)
