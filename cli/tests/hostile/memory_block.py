# Wants four gigabytes at once.
# expect: error "MemoryError"
import hrdsl
node = hrdsl.Node('robot')
bytearray(4 << 30)
