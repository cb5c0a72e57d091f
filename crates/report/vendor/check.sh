#!/bin/sh
# Makes the bundles again in a temporary folder and compares their bytes with those that are committed; then checks the types of all scripts.
# Needs Node 20 or newer and npm; building Bulge needs neither.
set -eu
crates=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# As they lie here: scripts find each other, and the bundles are written beside them.
mkdir -p "$folder/report" "$folder/workbench"
cp -R "$crates/report/vendor" "$crates/report/scripts" "$folder/report"
cp -R "$crates/workbench/page" "$folder/workbench"
rm -rf "$folder/report/vendor/node_modules"
cd "$folder/report/vendor"
if grep -q '"resolved"\|://' package-lock.json; then
    echo "package-lock.json names a host: leave out what is resolved (npm config set omit-lockfile-registry-resolved true)" >&2
    exit 1
fi
npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
node build.mjs
for made in report/scripts/vendor/echarts.js workbench/page/vendor/three.js report/scripts/report/bundle.js; do
    cmp "$folder/$made" "$crates/$made" || { echo "$made is not what build.mjs makes: run \`npm ci --ignore-scripts && node build.mjs\`" >&2; exit 1; }
done
for made in report/scripts/vendor/echarts.js workbench/page/vendor/three.js; do
    hash=$(sha256sum "$crates/$made" | cut -d ' ' -f 1)
    grep -q "$hash" README.md || { echo "README.md doesn't name the sha256 of $made, $hash" >&2; exit 1; }
done
# Modules look for their types upwards from where they lie.
ln -s "$folder/report/vendor/node_modules" "$folder/node_modules"
node_modules/.bin/tsc --noEmit -p "$folder/workbench/page/tsconfig.json"
size=$(cat "$folder"/workbench/page/*.* "$folder"/workbench/page/vendor/*.js "$folder"/report/scripts/*.* "$folder"/report/scripts/vendor/*.js | wc -c)
[ "$size" -lt 3000000 ] || { echo "the page weighs $size bytes, more than 3 MB" >&2; exit 1; }
echo "bundles are reproduced, types are right, the page weighs $size bytes"
