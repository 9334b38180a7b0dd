# The pictures of GALLERY.md, from nothing: made-up BRDFs and probes, their trees, and every scene of
# scenes/gallery by paths. Read by Makefile for the target gallery:
#
#   make -C pipelines gallery -j2
#
#   OUT         folder for everything made (default out/gallery here)
#   SHEET       contact sheet of all (default OUT/gallery.png; pictures/gallery.png is a copy of one)
#   SPP, RENDER_FLAGS    of haarrender, as in RENDER_FLAGS="--size 640x400"

.PHONY: gallery
names := one-object lamps room moving shadows mirrors
OUT ?= $(here)/out/gallery
SPP ?= 128
out := $(call absolute,$(OUT))
bin := $(call absolute,$(BIN))
sheet := $(call absolute,$(or $(SHEET),$(out)/gallery.png))
sources := $(foreach name,plastic metal paint,$(out)/brdf/$(name).binary $(out)/brdf/$(name).haar) \
  $(foreach name,studio sun-sky dusk,$(out)/source/$(name).hdr $(out)/probe/$(name).haar)
run = $(bin)/$(1) --quiet --threads $(THREADS)

gallery: $(sheet)

$(out)/source $(out)/brdf $(out)/probe $(out)/scene:
	mkdir -p $@

$(out)/brdf/plastic.binary: synth = --model ggx --diffuse 0.25,0.04,0.03 --roughness 0.12
$(out)/brdf/metal.binary: synth = --model ggx --specular 0.9,0.7,0.4 --roughness 0.08
$(out)/brdf/paint.binary: synth = --model ashikhmin-shirley --diffuse 0.05,0.15,0.4 --exponent 500
$(out)/brdf/%.binary: $(bin)/brdfsynth | $(out)/brdf
	$(call run,brdfsynth) $(synth) -o $@ >/dev/null

$(out)/source/studio.hdr: synth = --scene studio
$(out)/source/sun-sky.hdr: synth = --scene sun-sky --sun-elevation 40
$(out)/source/dusk.hdr: synth = --scene sun-sky --sun-elevation 0
$(out)/source/%.hdr: $(bin)/probesynth | $(out)/source
	$(call run,probesynth) $(synth) --size 256 -o $@ >/dev/null

$(out)/brdf/%.haar: $(out)/brdf/%.binary $(bin)/brdf2maps
	$(call run,brdf2maps) $< --size 256 --theta 32 -o $@ >/dev/null
$(out)/probe/%.haar: $(out)/source/%.hdr $(bin)/probe2maps | $(out)/probe
	$(call run,probe2maps) $< --size 512 -o $@ >/dev/null

$(out)/scene/%.json: $(here)/scenes/gallery/%.json | $(out)/scene
	cp $< $@
$(out)/room.exr: sampler = mis
$(out)/%.exr: sampler = product
$(out)/%.exr: $(out)/scene/%.json $(sources) $(bin)/haarrender
	$(call run,haarrender) $< -o $@ --png $(@:.exr=.png) --integrator path --sampler $(sampler) \
	  --spp $(SPP) $(RENDER_FLAGS) >$(@:.exr=.txt)

$(sheet): $(names:%=$(out)/%.exr) $(bin)/haarsheet
	$(call run,haarsheet) $(names:%=$(out)/%.exr) $(foreach name,$(names),--caption "$(name)") --columns 3 \
	  --tone-map filmic -o $@ >/dev/null
