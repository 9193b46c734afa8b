#!/bin/sh
# symbols_test.sh LIBRARY FOLDER: whether the library shows what sulcus.map and sulcus.h in the folder say,
# and nothing else.
set -eu
shown=$(nm -D --defined-only "$1" | sed -n 's/.* [A-Z] \(.*@@.*\)/\1/p' | sort)
others=$(nm -D --defined-only "$1" | grep -v -e '@@SULCUS_1$' -e ' A SULCUS_1$' || true)
mapped=$(sed -n 's/^ *\(sulcus_[a-z_]*\);/\1@@SULCUS_1/p' "$2/sulcus.map" | sort)
declared=$(tr '\n' ' ' <"$2/sulcus.h" | grep -o 'SULCUS_API [a-z0-9_* ]*sulcus_[a-z_]*(' |
  sed 's/.*[ *]\(sulcus_[a-z_]*\)($/\1@@SULCUS_1/' | sort)
[ -z "$others" ] || { echo "shown beside them: $others"; exit 1; }
[ "$shown" = "$mapped" ] || { echo "shown and listed in the map differ"; exit 1; }
[ "$declared" = "$mapped" ] || { echo "declared in the header and listed differ"; exit 1; }
[ "$(echo "$shown" | wc -l)" -gt 20 ]
