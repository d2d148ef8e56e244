# Overwrites the modules of the harness, as far as it may; it answers.
# expect: pass
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
for name in os.listdir(os.path.dirname(hrdsl.__file__)):
    try:
        open(os.path.join(os.path.dirname(hrdsl.__file__), name), 'w').write('raise 1')
    except OSError:
        pass
node.wait_for('asked')
node.emit('said', n=1)
