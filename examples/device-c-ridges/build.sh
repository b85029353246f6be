#!/bin/sh
# ./build.sh  builds the ridges as a native library
set -eu
cd "$(dirname "$0")"
case "$(uname -s)" in Darwin) suffix=dylib ;; *) suffix=so ;; esac
${CC:-cc} -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -fvisibility=hidden \
    -I ../../spec/include -shared -fPIC -o "ridges.$suffix" ridges.c -lm -pthread
echo "ridges.$suffix"
