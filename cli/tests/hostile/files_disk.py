# Fills its folder until there is no room.
# expect: error "No space left"
# needs: namespaces
import hrdsl
node = hrdsl.Node('robot')
with open('full', 'wb') as file:
    while True:
        file.write(bytes(1 << 20))
