# Writes more files than are kept.
# expect: error "only the first 10000 files are kept"
# needs: namespaces
# options: --keep-files
import hrdsl
node = hrdsl.Node('robot')
for n in range(10_100):
    open('f%d' % n, 'w').close()
node.wait_for('asked')
node.emit('said', n=1)
