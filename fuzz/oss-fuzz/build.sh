#!/bin/bash
# Builds every target for OSS-Fuzz: programs, seeds and dictionaries go to $OUT. It also runs alone
# if nightly Rust, cargo-fuzz and zip are installed: SRC=.. OUT=/somewhere fuzz/oss-fuzz/build.sh,
# where SRC contains the checkout as `husillo`.
set -euxo pipefail
cd "$SRC/husillo/fuzz"
mkdir -p "$OUT"
# Overflow checks and assertions stay on: fuzz/Cargo.toml enables them in releases too.
cargo +nightly fuzz build -O --fuzz-dir .
programs=${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release

for file in fuzz_targets/*.rs; do
    target=$(basename "$file" .rs)
    cp "$programs/$target" "$OUT/"
    zip -qj "$OUT/${target}_seed_corpus.zip" "corpus/$target"/*
    printf '[libfuzzer]\nmax_len = 512\n' >"$OUT/$target.options"
    case $target in
    gcode | reader | format | expressions | parameters | contour | machine)
        cp gcode.dict "$OUT/$target.dict"
        ;;
    excellon) cp excellon.dict "$OUT/" ;;
    esac
done
