# Makes a file of a terabyte that has nothing in it; it answers.
# expect: any
import hrdsl
node = hrdsl.Node('robot')
open('sparse', 'w').truncate(1 << 40)
node.wait_for('asked')
node.emit('said', n=1)
