# Ends with a code that no process has.
# expect: error "the program ended"
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.exit(10 ** 30)
