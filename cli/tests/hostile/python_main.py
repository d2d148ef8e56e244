# Takes itself for another module.
# expect: pass
import sys
import hrdsl
node = hrdsl.Node('robot')
del sys.modules['__main__']
__name__ = 'robot'
node.wait_for('asked')
node.emit('said', n=1)
