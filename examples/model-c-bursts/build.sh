#!/bin/sh
# ./build.sh       builds bursts as a native library
# ./build.sh wasm  builds bursts.wasm (wants clang and lld)
set -eu
cd "$(dirname "$0")"
# The same samples everywhere: no fused multiply-add. No call into a C library for square roots.
flags="-std=c11 -O2 -Wall -Wextra -ffp-contract=off -fno-math-errno -fvisibility=hidden"
case "${1:-native}" in
wasm)
    clang --target=wasm32 $flags -I ../../spec/include -I ../../sdk/check/templates/model-c -ffreestanding -nostdlib -Wl,--no-entry -o bursts.wasm bursts.c
    echo "bursts.wasm" ;;
native)
    case "$(uname -s)" in Darwin) suffix=dylib ;; *) suffix=so ;; esac
    ${CC:-cc} $flags -I ../../spec/include -I ../../sdk/check/templates/model-c -shared -fPIC -o "bursts.$suffix" bursts.c
    echo "bursts.$suffix" ;;
*)
    echo "usage: ./build.sh [native|wasm]" >&2
    exit 2 ;;
esac
