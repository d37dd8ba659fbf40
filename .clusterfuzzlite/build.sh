#!/bin/bash
# Builds the targets as for OSS-Fuzz.
exec "$SRC/husillo/fuzz/oss-fuzz/build.sh" "$@"
