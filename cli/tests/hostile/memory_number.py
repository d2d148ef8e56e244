# Squares a number until memory is used up.
# expect: error "within 1 s of processor time"
import hrdsl
node = hrdsl.Node('robot')
n = 3
while True:
    n *= n
