#!/bin/sh
# sh build.sh  builds {{NAME}} as a native library
set -eu
cd "$(dirname "$0")"
case "$(uname -s)" in Darwin) suffix=dylib ;; *) suffix=so ;; esac
${CC:-cc} -std=c11 -D_POSIX_C_SOURCE=200809L -O2 -Wall -Wextra -fvisibility=hidden \
    -shared -fPIC -o "{{NAME}}.$suffix" device.c -lm -pthread
echo "{{NAME}}.$suffix"
