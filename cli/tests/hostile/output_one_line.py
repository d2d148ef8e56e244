# Writes a line of three megabytes without an end; it answers.
# expect: pass
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.stdout.write('long' * 750_000)
node.wait_for('asked')
node.emit('said', n=1)
