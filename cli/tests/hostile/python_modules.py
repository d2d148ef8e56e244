# Forgets all modules; it answers.
# expect: any
import sys
import hrdsl
node = hrdsl.Node('robot')
answer, wait = node.emit, node.wait_for
sys.modules.clear()
wait('asked')
answer('said', n=1)
