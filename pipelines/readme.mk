# The pictures of README.md and GALLERY.md, from nothing, into pictures. Read by Makefile for the goal readme:
#
#   make -C pipelines readme -j2
#
#   OUT         folder for everything made (default out/readme here)
#   PICTURES    folder of the pictures (default pictures here)
#   SPP, RENDER_FLAGS    of the gallery

folder := gallery/
include $(here)/gallery.mk

views := lamp.exr level.exr environment.exr
.PHONY: demo gallery_picture gallery/scene/viewer.json $(views) viewer.png light.haar turning.png
readme: demo gallery_picture viewer.png turning.png

# Uses the programs in build/release, which it builds first.
demo:
	$(step) update demo/demo.png demo/contact-sheet.png -- "$$here/demo.sh" "$$bin/haarrender" -- \
	  bash "$$here/demo.sh" "$$out/demo"; \
	publish demo/demo.png "$$pictures/demo.png"; publish demo/contact-sheet.png "$$pictures/samplers.png"

gallery_picture: gallery_sheet
	$(step) cd -- "$$out"; publish gallery/gallery.png "$$pictures/gallery.png"

# The BRDFs and probes of the gallery are in the scene below, too.
gallery/scene/viewer.json: $(sources) $(trees)
	$(step) update $@ -- "$$here/scenes/viewer.json" -- cp -- "$$here/scenes/viewer.json" $@

$(views): flags =
level.exr: flags = --level 4
environment.exr: flags = --environment
$(views): gallery/scene/viewer.json
	$(step) update $@ $(@:.exr=.txt) -- $< $(sources) $(trees) -- haarview $< --image $@ $(flags)
viewer.png: $(views)
	$(step) update $@ -- $^ -- haarsheet $^ --caption "lamp" --caption "lamp, level 4" \
	  --caption "environment" --columns 3 --tone-map filmic -o $@; publish $@ "$$pictures/viewer.png"

light.haar: gallery/scene/viewer.json
	$(step) update $@ light.txt -- $< $(sources) $(trees) -- haarrelight build $< --vary light -o $@
turning.png: light.haar
	$(step) update $@ -- $< gallery/scene/viewer.json -- haarrelight sweep $< --scene gallery/scene/viewer.json \
	  --pictures 6 --on-sheet 6 -o $@; publish $@ "$$pictures/relight.png"
