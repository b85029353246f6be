#!/bin/sh
# sh build.sh       builds {{NAME}} as a native library
# sh build.sh wasm  builds {{NAME}}.wasm (wants clang and lld)
set -eu
cd "$(dirname "$0")"
# The same samples everywhere: no fused multiply-add. No call into a C library for square roots.
flags="-std=c11 -O2 -Wall -Wextra -ffp-contract=off -fno-math-errno -fvisibility=hidden"
case "${1:-native}" in
wasm)
    clang --target=wasm32 $flags -ffreestanding -nostdlib -Wl,--no-entry -o {{NAME}}.wasm model.c
    echo "{{NAME}}.wasm" ;;
native)
    case "$(uname -s)" in Darwin) suffix=dylib ;; *) suffix=so ;; esac
    ${CC:-cc} $flags -shared -fPIC -o "{{NAME}}.$suffix" model.c
    echo "{{NAME}}.$suffix" ;;
*)
    echo "usage: sh build.sh [native|wasm]" >&2
    exit 2 ;;
esac
