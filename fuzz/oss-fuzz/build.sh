#!/bin/bash
# Builds the targets for OSS-Fuzz and ClusterFuzzLite: programs, seeds, dictionaries and options go
# to $OUT. It also runs alone if nightly Rust, cargo-fuzz and zip are installed. $SRC contains the
# checkout as `husillo`, as in the images of OSS-Fuzz:
#
#   SRC=$PWD/.. OUT=/somewhere fuzz/oss-fuzz/build.sh [TARGET...]
set -euo pipefail
cd "$SRC/husillo/fuzz"
mkdir -p "$OUT"
targets=("$@")
((${#targets[@]})) || targets=($(basename -s .rs fuzz_targets/*.rs))
# The images have nightly as their only compiler.
nightly=$(rustc -V | grep -q nightly || echo +nightly)

# One build, unless targets are named: cargo-fuzz builds one of them or all. Overflow checks and
# assertions stay on, because fuzz/Cargo.toml enables them in releases too.
if (($#)); then
    for target in "$@"; do cargo $nightly fuzz build -O --fuzz-dir . "$target"; done
else
    cargo $nightly fuzz build -O --fuzz-dir .
fi
programs=${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release

for target in "${targets[@]}"; do
    cp "$programs/$target" "$OUT/"
    rm -f "$OUT/${target}_seed_corpus.zip"
    zip -qj "$OUT/${target}_seed_corpus.zip" "corpus/$target"/*
    printf '[libfuzzer]\nmax_len = 512\n' >"$OUT/$target.options"
    dictionary=$(./dictionary "$target")
    if [ -n "$dictionary" ]; then cp "$dictionary" "$OUT/$target.dict"; fi
done
