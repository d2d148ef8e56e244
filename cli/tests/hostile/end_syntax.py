# Is no Python.
# expect: error "SyntaxError"
def (:
