// The page: what is shown and told, and what mouse and sliders do.

/// Texture accesses of a pixel that has any, on average.
function accesses(rgba) {
  let sum = 0;
  let pixels = 0;
  for (let i = 3; i < rgba.length; i += 4) {
    sum += rgba[i];
    pixels += rgba[i] > 0 ? 1 : 0;
  }
  return sum / Math.max(pixels, 1);
}

function relativeRms(rgba, reference) {
  let error = 0;
  let energy = 0;
  for (let i = 0; i < reference.length; ++i) {
    const truth = reference[i];
    error += (rgba[Math.floor(i / 3) * 4 + (i % 3)] - truth) ** 2;
    energy += truth ** 2;
  }
  return Math.sqrt(energy > 0 ? error / energy : error);
}

/// With #check behind the page's name: how far this browser's frame lies from the one that the page
/// brings along, as text. #check,3 does so at level 3.
function check(viewer) {
  const level = Number(location.hash.split(",")[1] ?? -1);
  viewer.resize(scene.width, scene.height);
  viewer.programs[scene.lighting].integer("background", 0);
  viewer.draw(scene.lighting, level, scene.tolerance);
  const rgba = viewer.picture.read();
  viewer.present(0);
  const error = scene.reference ? relativeRms(rgba, new Float32Array(bytesOf(scene.reference))) : "none";
  element("result").textContent = `check ${scene.lighting} relative_rms ${error} accesses ${accesses(rgba)} gl_error ${gl.getError()}`;
}

function start(viewer) {
  const value = (id) => Number(element(id).value);
  const lighting = () => element("lighting").value;
  let asked = false;
  let quiet = 0;
  const figures = (ms, count) => {
    element("figures").textContent = `${ms.toFixed(1)} ms per frame` + (count ? `, ${count.toFixed(1)} texture accesses per pixel` : "");
  };
  const draw = () => {
    asked = false;
    viewer.resize(value("pixels"), Math.max(1, Math.round((value("pixels") * scene.height) / scene.width)));
    const tolerance = 10 ** value("tolerance");
    const ms = viewer.draw(lighting(), value("level"), tolerance);
    viewer.present(value("exposure"));
    figures(ms);
    element("level_text").value = value("level") < 0 ? "as needed" : value("level");
    element("tolerance_text").value = tolerance.toPrecision(2);
    element("exposure_text").value = value("exposure");
    element("pixels_text").value = value("pixels");
    element("tolerance_label").hidden = lighting() !== "environment";
    clearTimeout(quiet);
    quiet = setTimeout(() => figures(ms, accesses(viewer.picture.read())), 400);
  };
  const ask = () => {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  };

  element("title").textContent = document.title = scene.title;
  element("provenance").textContent = scene.provenance;
  if (viewer.programs.environment) element("lighting").add(new Option("environment", "environment"));
  element("lighting").value = scene.lighting;
  element("level").max = scene.levels;
  element("level").value = scene.level;
  element("tolerance").value = Math.log10(scene.tolerance);
  element("exposure").value = scene.exposure;
  element("pixels").value = Math.min(Math.max(scene.width, 64), 1024);
  element("form").addEventListener("input", ask);
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) return;
    const scale = 6 / canvas.clientWidth;
    if (event.shiftKey || event.buttons === 2) viewer.turnLight(event.movementX * scale, event.movementY * scale);
    else viewer.orbit(event.movementX * scale, event.movementY * scale);
    ask();
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    viewer.approach(Math.exp(0.001 * event.deltaY));
    ask();
  }, { passive: false });
  ask();
}

try {
  const viewer = new Viewer();
  if (location.hash.startsWith("#check")) check(viewer);
  else start(viewer);
} catch (error) {
  element("result").textContent = "It cannot be drawn: " + error.message;
}
