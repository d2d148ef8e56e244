# Writes two thousand files; it answers.
# expect: pass
# options: --keep-files
import hrdsl
node = hrdsl.Node('robot')
for n in range(2000):
    open('f%d' % n, 'w').close()
node.wait_for('asked')
node.emit('said', n=1)
