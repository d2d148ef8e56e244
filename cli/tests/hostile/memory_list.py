# Appends to a list for ever.
# expect: error "MemoryError"
import hrdsl
node = hrdsl.Node('robot')
many = []
while True:
    many.append([0] * 1000)
