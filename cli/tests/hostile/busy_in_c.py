# Computes a power for ever inside C code, deaf to signals.
# expect: error "within 1 s of processor time"
import hrdsl
node = hrdsl.Node('robot')
x = 7 ** (7 ** 9)
node.emit('said', n=1)
