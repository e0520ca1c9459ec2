#!/bin/sh
# Installs fakir by copying the files of this archive below a folder: ~/.local, or the one given.
#
#   ./install.sh [FOLDER]          for example: sudo ./install.sh /usr/local
#
# Nothing is downloaded, compiled or configured. The list of copied files is FOLDER/share/fakir/installed.txt;
# removing these files uninstalls fakir. DESTDIR is put in front of the folder, as packagers need it.
set -eu

if [ "$#" -gt 1 ]; then
    echo "usage: ./install.sh [FOLDER]" >&2
    exit 2
fi
if [ "$#" -eq 0 ] && [ -z "${HOME:-}" ]; then
    echo "HOME is not set: name a folder, as in ./install.sh /usr/local" >&2
    exit 2
fi
folder="${1:-${HOME:-}/.local}"
case "$folder" in
    -*) echo "usage: ./install.sh [FOLDER]" >&2; exit 2 ;;
    /*) ;;
    *) folder="$(pwd)/$folder" ;;
esac
root="${DESTDIR:-}$folder"
cd "$(dirname "$0")"

list="share/fakir/installed.txt"
mkdir -p "$root/share/fakir"
: > "$root/$list"
find bin share -type f | sort | while IFS= read -r file; do
    mkdir -p "$root/$(dirname "$file")"
    # A program that runs is replaced, not overwritten.
    cp "$file" "$root/$file.new"
    mv "$root/$file.new" "$root/$file"
    printf '%s\n' "$folder/$file" >> "$root/$list"
done
printf '%s\n' "$folder/$list" >> "$root/$list"
chmod 755 "$root/bin/fakir"

echo "installed fakir in $folder"
case ":${PATH:-}:" in
    *":$folder/bin:"*) ;;
    *) echo "add $folder/bin to PATH to run it as fakir" ;;
esac
