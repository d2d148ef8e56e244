# Reads the terminal and standard input; it answers.
# expect: pass
import sys
import hrdsl
node = hrdsl.Node('robot')
assert sys.stdin.read() == ''
try:
    open('/dev/tty').read()
    raise SystemExit('it has a terminal')
except OSError:
    pass
node.wait_for('asked')
node.emit('said', n=1)
