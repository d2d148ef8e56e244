# Forbids everybody to enter its folders; it answers.
# expect: pass
# options: --keep-files
import os
import hrdsl
node = hrdsl.Node('robot')
os.makedirs('a/b')
open('a/b/c', 'w').write('x')
os.chmod('a/b/c', 0)
os.chmod('a/b', 0)
os.chmod('a', 0)
os.chmod('.', 0)
node.wait_for('asked')
node.emit('said', n=1)
