//! End-to-end tests and the tests of the documents: see `tests/`.
