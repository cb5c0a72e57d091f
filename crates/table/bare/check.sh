#!/usr/bin/env bash
# Neither std nor alloc: builds the bare program, runs it, searches its symbols, and compiles the library for every microcontroller whose core
# library is installed (`rustup target add thumbv7em-none-eabihf`, for instance). Needs no network. An argument: where to build.
set -euo pipefail
cd "$(dirname "$0")"
target=${1:-../../../target/bare}
# Legacy and v0 names of the two crates, the functions of an allocator, and C's.
allocating='_ZN3std|_ZN5alloc|Cs[0-9A-Za-z]+_(3std|5alloc)|__rust_(alloc|dealloc|realloc|no_alloc)|__r(dl|g)_|rust_eh_personality|[mc]alloc|realloc'

cargo build --release --offline --quiet --manifest-path Cargo.toml --target-dir "$target"
program=$target/release/bulge-table-bare
timeout 10 "$program" || { echo "the bare program ended with $?" >&2; exit 1; }
echo "the bare program finds the right force"

# First that the search finds what it should: in a program with std.
with_std=$target/with-std
echo 'fn main() { println!("{:?}", std::env::args().collect::<Vec<_>>()); }' \
    | rustc --edition 2024 -C opt-level=1 -o "$with_std" -
found=$(nm "$with_std" | grep -cE "$allocating") || { echo "the search for std finds nothing where it is" >&2; exit 1; }
if nm "$program" | grep -E "$allocating"; then
    echo "the bare program has std or alloc in it" >&2
    exit 1
fi
echo "no symbol of std, of alloc or of an allocator in it (a program with std has $found)"

built=() skipped=()
for name in $(rustc --print target-list | grep -E -- '-none(-|$)'); do
    if compgen -G "$(rustc --print target-libdir --target "$name" 2>/dev/null)/libcore-*.rlib" > /dev/null; then
        cargo build --lib --release --offline --quiet --manifest-path Cargo.toml -p bulge-table \
            --target "$name" --target-dir "$target"
        built+=("$name")
    else
        skipped+=("$name")
    fi
done
echo "the library is compiled for ${#built[@]} bare targets: ${built[*]:-none is installed}"
echo "not installed: ${skipped[*]:-none}"
