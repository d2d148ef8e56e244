# Makes a folder in a folder, three thousand deep; it answers.
# expect: pass
# options: --keep-files
import os
import hrdsl
node = hrdsl.Node('robot')
for _ in range(3000):
    os.mkdir('d')
    os.chdir('d')
open('bottom', 'w').write('x')
node.wait_for('asked')
node.emit('said', n=1)
