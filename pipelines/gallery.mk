# The pictures of GALLERY.md, from nothing: synthesized BRDFs and probes, their trees, and every scene of
# scenes/gallery by paths. Read by Makefile for the goals gallery and readme:
#
#   make -C pipelines gallery -j2
#
#   OUT         folder for everything made (default out/gallery here)
#   SHEET       contact sheet of all (default OUT/gallery.png; pictures/gallery.png is a copy of one)
#   SPP, RENDER_FLAGS    of haarrender, as in RENDER_FLAGS="--size 640x400" (default: 128, none)
#
# `folder` is where in OUT: nothing, or a folder and a slash.

names := one-object lamps room moving shadows mirrors
brdfs := $(foreach name,plastic metal paint,$(folder)brdf/$(name))
probes := $(foreach name,studio sun-sky dusk,$(folder)probe/$(name))
sources := $(brdfs:=.binary) $(probes:$(folder)probe/%=$(folder)source/%.hdr)
trees := $(brdfs:=.haar) $(probes:=.haar)
scenes := $(foreach name,$(names),$(folder)scene/$(name).json)
gallery_pictures := $(foreach name,$(names),$(folder)$(name).exr)
.PHONY: $(sources) $(trees) $(scenes) $(gallery_pictures) gallery_sheet

gallery: gallery_sheet

$(folder)brdf/plastic.binary: synth = --model ggx --diffuse 0.25,0.04,0.03 --roughness 0.12
$(folder)brdf/metal.binary: synth = --model ggx --specular 0.9,0.7,0.4 --roughness 0.08
$(folder)brdf/paint.binary: synth = --model ashikhmin-shirley --diffuse 0.05,0.15,0.4 --exponent 500
$(brdfs:=.binary):
	$(step) update $@ -- -- brdfsynth $(synth) -o $@

$(folder)source/studio.hdr: synth = --scene studio
$(folder)source/sun-sky.hdr: synth = --scene sun-sky --sun-elevation 40
$(folder)source/dusk.hdr: synth = --scene sun-sky --sun-elevation 0
$(filter %.hdr,$(sources)):
	$(step) update $@ -- -- probesynth $(synth) --size 256 -o $@

$(brdfs:=.haar): %.haar: %.binary
	$(step) update $@ -- $< -- brdf2maps $< --size 256 --theta 32 -o $@
$(probes:=.haar): $(folder)probe/%.haar: $(folder)source/%.hdr
	$(step) update $@ -- $< -- probe2maps $< --size 512 -o $@

$(scenes): $(folder)scene/%.json:
	$(step) template="$$here/scenes/gallery/$*.json"; update $@ -- "$$template" -- cp -- "$$template" $@

$(gallery_pictures): sampler = product
$(folder)room.exr: sampler = mis
$(gallery_pictures): $(folder)%.exr: $(folder)scene/%.json $(sources) $(trees)
	$(step) update $@ $(@:.exr=.png) $(@:.exr=.txt) -- $^ -- haarrender $< -o $@ --image $(@:.exr=.png) \
	  --integrator path --sampler $(sampler) --spp "$$spp" "$${render_flags[@]}"

gallery_sheet: $(gallery_pictures)
	$(step) update $(folder)gallery.png -- $^ -- haarsheet $^ $(foreach name,$(names),--caption $(name)) \
	  --columns 3 --tone-map filmic -o $(folder)gallery.png; \
	publish $(folder)gallery.png "$${sheet:-$(folder)gallery.png}"
