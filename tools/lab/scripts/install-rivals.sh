#!/usr/bin/env bash
# Installs the codecs that `tessera rd` compares with from Debian, and lists which are installed.
#   tools/lab/scripts/install-rivals.sh            installs missing codecs (as root)
#   tools/lab/scripts/install-rivals.sh --list     only lists them
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
PACKAGES="x265 ffmpeg aom-tools libavif-bin libjxl-tools astcenc zfp"

# The tools of each package. The first one is asked for its version.
TOOLS="x265:x265 ffmpeg:ffmpeg aom-tools:aomenc libavif-bin:avifenc,avifdec
libjxl-tools:cjxl,djxl astcenc:astcenc zfp:zfp"

list_rivals() {
    say "Rivals"
    local missing=0
    for entry in $TOOLS; do
        local package=${entry%%:*} tools=${entry#*:} state="installed"
        for tool in ${tools//,/ }; do
            command -v "$tool" >/dev/null || state="MISSING"
        done
        [ "$state" = installed ] || missing=1
        printf '  %-18s %-30s %-10s %s\n' "$package" "$tools" "$state" \
            "$(dpkg-query -W -f '${Version}' "$package" 2>/dev/null || true)"
    done
    printf '  %-18s %-30s %-10s %s\n' "(OpenEXR DWAA)" "-" "built in" ""
    [ $missing = 0 ] || printf '\ntessera rd leaves out missing codecs and lists them in its reports.\n'
}

# Prints the packages that this Debian release has. apt-get would install none of them if one were
# unknown.
known_packages() {
    local known=""
    for package in $PACKAGES; do
        if apt-cache show "$package" >/dev/null 2>&1; then
            known="$known $package"
        else
            say "This Debian release has no package $package" >&2
        fi
    done
    printf '%s' "$known"
}

if [ "${1:-}" != "--list" ]; then
    [ "$(id -u)" != 0 ] || apt-get update -qq || stop "apt-get update failed (no network?)"
    PACKAGES=$(known_packages)
    install_missing
fi
list_rivals
