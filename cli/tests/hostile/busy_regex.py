# Matches a regular expression that needs exponential time.
# expect: error "within 1 s of processor time"
import re
import hrdsl
node = hrdsl.Node('robot')
re.match('(a+)+$', 'a' * 64 + 'b')
