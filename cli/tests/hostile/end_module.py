# Imports what does not exist.
# expect: error "ModuleNotFoundError"
import no_such_module_at_all
