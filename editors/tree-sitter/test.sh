#!/bin/sh
# Tests the grammar: what is generated is what is committed, the corpus, the queries, and every text of the language in
# the repository that the compiler reads without fault.
#
# Needs a C compiler, cargo and Node (which runs grammar.js). The command line of tree-sitter is built once, into
# target/tools; `test.sh --tools` does that alone.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
tools=$target/tools
version=0.27.1
cli=$tools/bin/tree-sitter

if ! [ "$("$cli" --version 2>/dev/null)" = "tree-sitter $version" ]; then
  CARGO_TARGET_DIR=$tools/build CARGO_PROFILE_RELEASE_OPT_LEVEL=0 \
    CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 \
    cargo install tree-sitter-cli --version "$version" --locked --no-default-features --root "$tools" --force
  rm -rf "$tools/build"
fi
if [ "${1:-}" = --tools ]; then
  exit 0
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '{ "parser-directories": ["%s"] }\n' "$root/editors" >"$work/config.json"
# Compiled grammars stay in the target folder too.
export XDG_CACHE_HOME="$tools/cache"

cd "$here"

echo "tree-sitter: the generated files"
"$cli" generate --abi 14 --output "$work/src"
for file in parser.c grammar.json node-types.json; do
  cmp "$work/src/$file" "src/$file" || {
    echo "src/$file is not what grammar.js makes: run '$cli generate --abi 14' in editors/tree-sitter" >&2
    exit 1
  }
done

echo "tree-sitter: the corpus"
"$cli" test --rebuild --config-path "$work/config.json"

echo "tree-sitter: the queries"
for query in queries/*.scm; do
  "$cli" query --grammar-path . --quiet --config-path "$work/config.json" "$query" \
    "$root/examples/handover/scenario.hri" >/dev/null
done

echo "tree-sitter: what the compiler accepts"
(cd "$root" && cargo test --quiet --workspace --test editors)
find "$target/tmp/accepted" -name '*.hri' | sort >"$work/accepted"
"$cli" parse --grammar-path . --quiet --stat --config-path "$work/config.json" --paths "$work/accepted"

echo "tree-sitter: as many nodes as the compiler"
"$cli" parse --grammar-path . --no-ranges --config-path "$work/config.json" --paths "$work/accepted" >"$work/trees"
{
  echo "declaration $(grep -cE '^  \(([a-z]+_declaration|allow)' "$work/trees")"
  for node in quantity binary_expression edge location act_step plan; do
    echo "$node $(grep -oE "\($node( |\)|$)" "$work/trees" | wc -l | tr -d ' ')"
  done
} >"$work/counts"
diff "$target/tmp/accepted/counts" "$work/counts"
if grep -q '(missing_brace' "$work/trees"; then
  echo "a brace is said to be missing in a text that the compiler accepts" >&2
  exit 1
fi
