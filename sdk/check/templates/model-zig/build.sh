#!/bin/sh
# sh build.sh       builds {{NAME}} as a native library
# sh build.sh wasm  builds {{NAME}}.wasm
# The environment variable ZIG names the compiler, e.g. ZIG="python3 -m ziglang".
set -eu
cd "$(dirname "$0")"
case "${1:-native}" in
wasm)
    file={{NAME}}.wasm
    how="build-exe -target wasm32-freestanding -fno-entry -rdynamic" ;;
native)
    case "$(uname -s)" in Darwin) suffix=dylib ;; *) suffix=so ;; esac
    file={{NAME}}.$suffix
    how="build-lib -dynamic -mcpu baseline" ;;
*)
    echo "usage: sh build.sh [native|wasm]" >&2
    exit 2 ;;
esac
${ZIG:-zig} $how -O ReleaseFast -fstrip -I . -femit-bin="$file" model.zig
rm -f "$file.o"
echo "$file"
