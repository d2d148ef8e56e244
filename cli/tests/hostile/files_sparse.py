# Makes a file of a terabyte that has nothing in it; it is not kept.
# expect: error "could not be kept"
# needs: namespaces
# options: --keep-files
import hrdsl
node = hrdsl.Node('robot')
open('sparse', 'w').truncate(1 << 40)
node.wait_for('asked')
node.emit('said', n=1)
