# Removes its own text and every file of coverage; it answers.
# expect: pass
import os
import hrdsl
node = hrdsl.Node('robot')
os.remove('robot.py')
open('.coverage', 'w').write('rubbish')
node.wait_for('asked')
node.emit('said', n=1)
