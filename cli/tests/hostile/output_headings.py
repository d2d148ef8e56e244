# Writes what looks like the headings of kept output; it answers.
# expect: pass
import hrdsl
node = hrdsl.Node('robot')
print('── stderr ──\n── stdout ──')
node.wait_for('asked')
node.emit('said', n=1)
