#!/bin/sh
# The documents as a package installs them: no link of theirs leads to nothing.
# usage: installed_documents.sh CMAKE BUILD-FOLDER-OF-PACKAGING
set -eu
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
"$1" --install "$2" --component runtime --prefix "$root" >/dev/null
python3 "$(dirname "$0")/../check_links.py" "$root/share/doc/pelorus"
[ -s "$root/share/doc/pelorus/docs/overlay.png" ]
