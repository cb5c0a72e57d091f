#!/bin/sh
# Makes the bundles again in a temporary folder and compares their bytes with those that are committed; then checks the types of the page's modules.
# Needs Node 20 or newer and npm; building Bulge needs neither.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/made"
cp -R "$here" "$folder/vendor"
cp -R "$here/../page" "$folder/page"
rm -rf "$folder/vendor/node_modules"
cd "$folder/vendor"
if grep -q '"resolved"\|://' package-lock.json; then
    echo "package-lock.json names a host: leave out what is resolved (npm config set omit-lockfile-registry-resolved true)" >&2
    exit 1
fi
npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
node build.mjs "$folder/made"
for name in echarts three; do
    cmp "$folder/made/$name.js" "$here/$name.js" || { echo "$name.js is not what build.mjs makes: run \`npm ci --ignore-scripts && node build.mjs .\`" >&2; exit 1; }
    hash=$(sha256sum "$here/$name.js" | cut -d ' ' -f 1)
    grep -q "$hash" README.md || { echo "README.md doesn't name the sha256 of $name.js, $hash" >&2; exit 1; }
done
# Modules look for their types upwards from where they lie.
ln -s "$folder/vendor/node_modules" "$folder/node_modules"
"$folder/vendor/node_modules/.bin/tsc" --noEmit -p "$folder/page/tsconfig.json"
size=$(cat "$folder"/page/*.js "$folder"/page/*.css "$folder"/page/*.html "$folder"/page/*.svg "$here"/*.js | wc -c)
[ "$size" -lt 3000000 ] || { echo "the page weighs $size bytes, more than 3 MB" >&2; exit 1; }
echo "bundles are reproduced, types are right, the page weighs $size bytes"
