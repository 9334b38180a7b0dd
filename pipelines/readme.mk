# The pictures of README.md and GALLERY.md, from nothing, into pictures. Read by Makefile for the target
# readme, which calls for the others:
#
#   make -C pipelines readme -j2
#
#   OUT         folder for everything made (default out/readme here)
#   PICTURES    folder of the pictures (default pictures here)

.PHONY: readme
OUT ?= $(here)/out/readme
PICTURES ?= $(here)/pictures
out := $(call absolute,$(OUT))
bin := $(call absolute,$(BIN))
pictures := $(call absolute,$(PICTURES))
scene := $(out)/gallery/scene/viewer.json
run = $(bin)/$(1) --quiet --threads $(THREADS)

readme: $(pictures)/demo.png $(pictures)/samplers.png $(pictures)/gallery.png $(pictures)/viewer.png \
  $(pictures)/relight.png

$(out) $(pictures):
	mkdir -p $@

$(out)/demo.made: $(here)/demo.sh $(bin)/haarrender | $(out)
	bash $< $(out)/demo
	touch $@
$(pictures)/demo.png: $(out)/demo.made | $(pictures)
	cp $(out)/demo/demo.png $@
$(pictures)/samplers.png: $(out)/demo.made | $(pictures)
	cp $(out)/demo/contact-sheet.png $@

# Its BRDFs and probes serve the scenes below.
$(out)/gallery.made: $(here)/gallery.mk $(bin)/haarrender | $(out)
	$(MAKE) --no-print-directory -C $(here) gallery OUT=$(out)/gallery BIN=$(bin)
	touch $@
$(pictures)/gallery.png: $(out)/gallery.made | $(pictures)
	cp $(out)/gallery/gallery.png $@
$(scene): $(here)/scenes/viewer.json $(out)/gallery.made
	cp $< $@

$(out)/lamp.exr: flags =
$(out)/level.exr: flags = --level 4
$(out)/environment.exr: flags = --environment
$(out)/lamp.exr $(out)/level.exr $(out)/environment.exr: $(scene) $(bin)/haarview
	$(call run,haarview) $< --frame $@ $(flags) >$(@:.exr=.txt)
$(pictures)/viewer.png: $(out)/lamp.exr $(out)/level.exr $(out)/environment.exr | $(pictures)
	$(call run,haarsheet) $^ --caption "lamp" --caption "lamp, level 4" --caption "environment" \
	  --columns 3 --tone-map filmic -o $@ >/dev/null

$(out)/light.haar: $(scene) $(bin)/haarrelight
	$(bin)/haarrelight build $< --quiet --threads $(THREADS) --vary light -o $@ >$(@:.haar=.txt)
$(pictures)/relight.png: $(out)/light.haar | $(pictures)
	$(bin)/haarrelight sweep $< --quiet --threads $(THREADS) --scene $(scene) --frames 6 --on-sheet 6 \
	  -o $(out)/turning.png >/dev/null
	cp $(out)/turning.png $@
