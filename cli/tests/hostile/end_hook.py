# Fails while it says how it failed.
# expect: error "the program ended (exit code 1)"
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.excepthook = lambda *_: 1 / 0
1 / 0
