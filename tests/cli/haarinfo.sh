#!/usr/bin/env bash
# haarinfo --html: pages about sets of every kind, their sections, and that they are self-contained.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.1 --roughness 0.4 -q -o ggx.binary >/dev/null
"$bin/brdf2maps" ggx.binary -q --size 32 --theta 8 --conservation-tolerance 1 -o brdf.haar >/dev/null
"$bin/brdf2maps" ggx.binary -q --size 16 --theta 3 --roll 8 --conservation-tolerance 1 -o rolls.haar >/dev/null
"$bin/probesynth" --scene studio --size 64 -q -o studio.hdr >/dev/null
"$bin/probe2maps" studio.hdr -q --size 64 -o world.haar >/dev/null
"$bin/probe2maps" studio.hdr -q --size 32 --orientations 3 -o set.exr >/dev/null
expect 0 maps2haar set.exr -o table.haar --criterion l2 --tolerance 0.1
expect 0 maps2haar set.exr -o packed.haar --criterion l2 --tolerance 0.1 --pack
expect 0 maps2haar set.exr -o grey.haar --luminance
grey_scene scene.json 12 8 '"probe": "studio.hdr", "haar": "world.haar"'
expect 0 haarrelight build scene.json --vary light --tolerance 0.05 --resolution 32 -o transfer.haar

cat >"$log/check.py" <<'END'
import re
import sys
from html.parser import HTMLParser

class Page(HTMLParser):
    empty = {"meta", "img", "link", "br", "hr"}
    def __init__(self):
        super().__init__()
        self.open, self.seen = [], set()
    def handle_starttag(self, tag, attributes):
        self.seen.add(tag)
        assert tag not in {"script", "link", "iframe", "object", "base"}, tag
        for name, value in attributes:
            assert not name.startswith("on"), name
            assert name != "href", value
            assert name != "src" or value.startswith("data:image/png;base64,"), value
        if tag not in self.empty:
            self.open.append(tag)
    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        self.open.pop()
    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, tag

text = open(sys.argv[1], encoding="utf-8").read()
page = Page()
page.feed(text)
page.close()
assert page.open == [], page.open
assert {"html", "title", "svg", "img", "table"} <= page.seen, page.seen
numbers = re.sub(r"base64,[A-Za-z0-9+/=]*", "", text)
assert not re.search(r"(?<![a-z])(nan|inf)(?![a-z])", numbers)
END

# page FILE ARGUMENTS…: a page that is whole, to $log/page.html
page() {
  local file=$1
  shift
  expect 0 haarinfo "$file" --html page.html "$@"
  [ ! -e page.html ] || mv page.html "$log/page.html"
  if has python3; then check "$file: well-formed" python3 "$log/check.py" "$log/page.html"; fi
  grep -qE 'https?://|url\(' "$log/page.html" && fail "$file: the page is not self-contained"
  return 0
}
# holds WORDS, lacks WORDS: of the last page
holds() { grep -qF -- "$1" "$log/page.html" || fail "the page lacks '$1'"; }
lacks() { if grep -qF -- "$1" "$log/page.html"; then fail "the page holds '$1'"; fi; }

# every kind of set; lobes are of BRDF sets, worst maps of sets whose maps are given
for file in brdf rolls world table packed grey transfer; do
  page $file.haar
  prints "nodes"
  for part in "<h1>$file.haar</h1>" "Error by coefficients kept" "By level" Provenance; do
    holds "$part"
  done
  lacks "Worst maps"
  case $file in
  brdf | rolls) holds "In the plane of incidence, by direction" ;;
  *) lacks "plane of incidence, by" ;;
  esac
done
page brdf.haar --tree 3,0 --level 3
holds "<h1>brdf.haar[3,0]</h1>"
holds "θ_r = 39.4°"
lacks "θ_r = 5.6°"

# the worst map is the one that haardiff finds; a packed file is compared all the same
expect 0 haardiff set.exr table.haar --json
worst_map
for file in table packed; do
  page $file.haar --reference set.exr
  holds "Worst maps"
  grep -m 1 -o '<figcaption>original [0-9,]*' "$log/page.html" | grep -qx "<figcaption>original $column,$row" ||
    fail "$file: the first of the worst maps is not $column,$row"
done
page table.haar --reference packed.haar --tree 2,1
holds "original 2,1"

# the same bytes for any threads and from anywhere
page table.haar --reference set.exr --threads 1
cp "$log/page.html" "$log/one.html"
page ../work/table.haar --reference ../work/set.exr --threads 2
same "$log/one.html" "$log/page.html"

# hostile names and provenance stay text
name="<script>alert(1)</script>&\"'.haar"
cp table.haar "${name//\//}" 2>/dev/null
cp set.exr "<img src=x onerror=y>.exr"
expect 0 maps2haar "<img src=x onerror=y>.exr" -o hostile.haar
page hostile.haar --reference "<img src=x onerror=y>.exr"
holds "&lt;img src=x onerror=y&gt;.exr"
lacks "<img src=x"
page "${name//\//}"
holds "&lt;script&gt;alert(1)&lt;script&gt;&amp;&quot;&#39;.haar"
lacks "<script"
rm "${name//\//}" hostile.haar "<img src=x onerror=y>.exr"

# misuse, broken files and outputs that cannot be written
expect 2 haarinfo table.haar --html x.png
expect 2 haarinfo table.haar --reference set.exr
expect 3 haarinfo table.haar --html x.html --reference studio.hdr
expect 3 haarinfo table.haar --html x.html --reference brdf.haar
expect 3 haarinfo table.haar --html x.html --reference missing.exr
size=$(stat -c %s table.haar)
for offset in 9 30 120 $((size / 2)); do
  cp table.haar bad.haar
  patch bad.haar "$offset" '\245'
  expect 3 haarinfo bad.haar --html x.html
  says bad.haar
  expect 3 haarinfo table.haar --html x.html --reference bad.haar
done
rm bad.haar
refuses_bad_input x.html haarinfo @ --html x.html
refuses_bad_output .html haarinfo table.haar --html @
leaves ggx.binary brdf.haar rolls.haar studio.hdr world.haar set.exr table.haar packed.haar grey.haar scene.json \
  transfer.haar
finish
