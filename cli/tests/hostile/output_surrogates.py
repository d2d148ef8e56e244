# Prints halves of characters; it answers.
# expect: pass
import hrdsl
node = hrdsl.Node('robot')
print('\ud800', '\udcff')
node.wait_for('asked')
node.emit('said', n=1)
