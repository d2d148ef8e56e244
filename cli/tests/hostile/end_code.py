# Ends with a code.
# expect: error "the program ended (exit code 7)"
import sys
import hrdsl
node = hrdsl.Node('robot')
sys.exit(7)
