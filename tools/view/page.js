"use strict";
// The page: draws its scene with haarview's shaders in WebGL 2, and responds to mouse and controls.

const scene = JSON.parse(document.getElementById("scene").textContent);
const element = (id) => document.getElementById(id);
const canvas = element("canvas");
const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

function compiled(kind, text) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, "#version 300 es\n" + text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

class Program {
  constructor(fragment) {
    this.id = gl.createProgram();
    gl.attachShader(this.id, compiled(gl.VERTEX_SHADER, scene.shaders.full_screen));
    gl.attachShader(this.id, compiled(gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(this.id);
    if (!gl.getProgramParameter(this.id, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.id));
  }
  location(name) {
    gl.useProgram(this.id);
    return gl.getUniformLocation(this.id, name);
  }
  floats(name, values) { gl["uniform" + values.length + "fv"](this.location(name), values); }
  integer(name, value) { gl.uniform1i(this.location(name), value); }
  matrix(name, columns) { gl.uniformMatrix3fv(this.location(name), false, columns); }
  texture(name, unit, texture) {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(texture.target, texture.id);
    this.integer(name, unit);
  }
}

const formats = {
  R32F: [gl && gl.R32F, gl && gl.RED, gl && gl.FLOAT, 4, Float32Array],
  Rgba32F: [gl && gl.RGBA32F, gl && gl.RGBA, gl && gl.FLOAT, 16, Float32Array],
  Rgba16F: [gl && gl.RGBA16F, gl && gl.RGBA, gl && gl.HALF_FLOAT, 8, Uint16Array],
  R32Ui: [gl && gl.R32UI, gl && gl.RED_INTEGER, gl && gl.UNSIGNED_INT, 4, Uint32Array],
  Rgba32Ui: [gl && gl.RGBA32UI, gl && gl.RGBA_INTEGER, gl && gl.UNSIGNED_INT, 16, Uint32Array],
};

function makeTexture(packed) {
  const target = packed.depth > 0 ? gl.TEXTURE_3D : gl.TEXTURE_2D;
  const most = gl.getParameter(packed.depth > 0 ? gl.MAX_3D_TEXTURE_SIZE : gl.MAX_TEXTURE_SIZE);
  for (const side of [packed.width, packed.height, packed.depth])
    if (side > most) throw new Error(`the scene needs a texture with a side of ${side} texels; the limit of this browser is ${most}`);
  const id = gl.createTexture();
  gl.activeTexture(gl.TEXTURE15);
  gl.bindTexture(target, id);
  const filter = packed.depth > 0 ? gl.LINEAR : gl.NEAREST;
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, packed.mips ? gl.NEAREST_MIPMAP_NEAREST : filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(target, wrap, gl.CLAMP_TO_EDGE);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  const [internal, format, type, size, Values] = formats[packed.format];
  const buffer = packed.bytes === undefined ? null : bytesOf(packed.bytes);
  let offset = 0;
  for (let mip = 0; mip === 0 || (packed.mips && packed.width >> mip > 0); ++mip) {
    const width = packed.width >> mip;
    const height = packed.height >> mip;
    const count = (width * height * Math.max(packed.depth, 1) * size) / Values.BYTES_PER_ELEMENT;
    const values = buffer && new Values(buffer, offset, count);
    if (packed.depth > 0) gl.texImage3D(target, 0, internal, width, height, packed.depth, 0, format, type, values);
    else gl.texImage2D(target, mip, internal, width, height, 0, format, type, values);
    offset += count * Values.BYTES_PER_ELEMENT;
  }
  return { target, id };
}

class RenderTarget {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.texture = makeTexture({ format: "Rgba32F", width, height, depth: 0, mips: false });
    this.framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.texture.id, 0);
  }
  destroy() {
    gl.deleteFramebuffer(this.framebuffer);
    gl.deleteTexture(this.texture.id);
  }
  read() {
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    const rgba = new Float32Array(4 * this.width * this.height);
    gl.readPixels(0, 0, this.width, this.height, gl.RGBA, gl.FLOAT, rgba);
    return rgba;
  }
}

const add = (a, b) => a.map((x, i) => x + b[i]);
const scaled = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const normalized = (a) => scaled(a, 1 / Math.hypot(...a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/// Rotates v about a unit axis (Rodrigues).
function rotated(v, axis, angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return add(add(scaled(v, c), scaled(cross(axis, v), s)), scaled(axis, dot(axis, v) * (1 - c)));
}

class Viewer {
  constructor() {
    if (!gl) throw new Error("this browser has no WebGL 2");
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("this browser cannot render to float textures (EXT_color_buffer_float)");
    this.programs = { punctual: new Program(scene.shaders.punctual) };
    if (scene.shaders.environment) this.programs.environment = new Program(scene.shaders.environment);
    this.toneMap = new Program(scene.shaders.tone_map);
    this.textures = scene.textures.map((packed) => [packed.sampler, makeTexture(packed)]);
    this.camera = structuredClone(scene.camera);
    this.light = structuredClone(scene.punctual);
    this.toWorld = scene.to_world.slice();
    this.picture = null;
    for (const program of Object.values(this.programs)) {
      for (const [name, values] of Object.entries(scene.floats)) program.floats(name, values);
      for (const [name, value] of Object.entries(scene.integers)) program.integer(name, value);
      program.integer("show_background", scene.background ? 1 : 0);
    }
  }

  resize(width, height) {
    if (this.picture && this.picture.width === width && this.picture.height === height) return;
    if (this.picture) this.picture.destroy();
    this.picture = new RenderTarget(width, height);
    canvas.width = width;
    canvas.height = height;
  }

  /// Sets the camera uniforms of scene.glsl.
  setCamera(program) {
    const { from, to, up, fov, height } = this.camera;
    const h = this.picture.height;
    const parallel = this.camera.projection === "orthographic";
    const forward = normalized(add(to, scaled(from, -1)));
    const right = normalized(cross(forward, normalized(up)));
    const upwards = cross(right, forward);
    const pixel = (2 * (parallel ? 0.5 * height : Math.tan((0.5 * fov * Math.PI) / 180))) / h;
    const corner = add(scaled(upwards, 0.5 * h * pixel), scaled(right, -0.5 * this.picture.width * pixel));
    const across = scaled(right, pixel);
    const down = scaled(upwards, -pixel);
    const none = [0, 0, 0];
    program.floats("ray_origin", parallel ? add(from, corner) : from);
    program.floats("ray_origin_x", parallel ? across : none);
    program.floats("ray_origin_y", parallel ? down : none);
    program.floats("ray_direction", parallel ? forward : add(forward, corner));
    program.floats("ray_direction_x", parallel ? none : across);
    program.floats("ray_direction_y", parallel ? none : down);
    program.floats("pixel_size", parallel ? [pixel, 0] : [0, pixel]);
  }

  /// Draws, waits until the GPU is done, and returns the milliseconds.
  draw(lighting, level, tolerance) {
    const program = this.programs[lighting];
    this.setCamera(program);
    const position = this.light.is_point ? this.light.place : normalized(this.light.place);
    program.floats("light", [...position, this.light.is_point ? 1 : 0]);
    program.floats("irradiance", this.light.irradiance);
    program.matrix("to_world", this.toWorld);
    program.floats("tolerance", [tolerance]);
    program.integer("forced_level", level);
    this.textures.forEach(([name, texture], unit) => program.texture(name, unit, texture));
    const begin = performance.now();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.picture.framebuffer);
    gl.viewport(0, 0, this.picture.width, this.picture.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4)); // waits; finish() may return early
    return performance.now() - begin;
  }

  present(exposure) {
    this.toneMap.floats("viewport", [0, 0, canvas.width, canvas.height]);
    this.toneMap.floats("exposure", [exposure]);
    this.toneMap.texture("picture", 0, this.picture.texture);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  orbit(right, down) {
    const camera = this.camera;
    const back = add(camera.from, scaled(camera.to, -1));
    const up = normalized(camera.up);
    const side = normalized(cross(up, back));
    const distance = Math.hypot(...back);
    const height = Math.acos(dot(back, up) / distance);
    const step = Math.min(Math.max(height - down, 0.02), Math.PI - 0.02) - height;
    camera.from = add(camera.to, rotated(rotated(back, side, step), up, -right));
  }

  rotateLight(right, down) {
    const up = normalized(this.camera.up);
    const side = normalized(cross(up, add(this.camera.from, scaled(this.camera.to, -1))));
    this.light.place = rotated(rotated(this.light.place, up, right), side, down);
    for (let axis = 0; axis < 3; ++axis)
      this.toWorld.splice(3 * axis, 3, ...rotated(this.toWorld.slice(3 * axis, 3 * axis + 3), up, right));
  }

  zoom(factor) {
    const back = add(this.camera.from, scaled(this.camera.to, -1));
    this.camera.from = add(this.camera.to, scaled(back, factor));
    this.camera.height *= factor;
  }
}

/// Texture accesses, mean over the pixels that have any.
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
    const expected = reference[i];
    error += (rgba[Math.floor(i / 3) * 4 + (i % 3)] - expected) ** 2;
    energy += expected ** 2;
  }
  return Math.sqrt(energy > 0 ? error / energy : error);
}

/// #check in the page's address: prints the relative RMS difference between this browser's frame and
/// the reference in the page. #check,3 compares level 3.
function check(viewer) {
  const level = Number(location.hash.split(",")[1] ?? -1);
  viewer.resize(scene.width, scene.height);
  viewer.programs[scene.lighting].integer("show_background", 0);
  viewer.draw(scene.lighting, level, scene.tolerance);
  const rgba = viewer.picture.read();
  viewer.present(0);
  const error = scene.reference ? relativeRms(rgba, new Float32Array(bytesOf(scene.reference))) : "none";
  element("result").textContent = `check ${scene.lighting} relative_rms ${error} accesses ${accesses(rgba)} gl_error ${gl.getError()}`;
}

function start(viewer) {
  const value = (id) => Number(element(id).value);
  const lighting = () => element("lighting").value;
  let requested = false;
  let timer = 0;
  const figures = (ms, count) => {
    element("figures").textContent = `${ms.toFixed(1)} ms per frame` + (count ? `, ${count.toFixed(1)} texture accesses per pixel` : "");
  };
  const draw = () => {
    requested = false;
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
    clearTimeout(timer);
    timer = setTimeout(() => figures(ms, accesses(viewer.picture.read())), 400);
  };
  const requestDraw = () => {
    if (!requested) requestAnimationFrame(draw);
    requested = true;
  };

  element("title").textContent = document.title;
  element("provenance").textContent = scene.provenance;
  if (viewer.programs.environment) element("lighting").add(new Option("environment", "environment"));
  element("lighting").value = scene.lighting;
  element("level").max = scene.levels;
  element("level").value = scene.level;
  element("tolerance").value = Math.log10(scene.tolerance);
  element("exposure").value = scene.exposure;
  element("pixels").value = Math.min(Math.max(scene.width, 64), 1024);
  element("form").addEventListener("input", requestDraw);
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) return;
    const scale = 6 / canvas.clientWidth;
    if (event.shiftKey || event.buttons === 2) viewer.rotateLight(event.movementX * scale, event.movementY * scale);
    else viewer.orbit(event.movementX * scale, event.movementY * scale);
    requestDraw();
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    viewer.zoom(Math.exp(0.001 * event.deltaY));
    requestDraw();
  }, { passive: false });
  requestDraw();
}

try {
  const viewer = new Viewer();
  if (location.hash.startsWith("#check")) check(viewer);
  else start(viewer);
} catch (error) {
  element("result").textContent = "The scene cannot be drawn: " + error.message;
}
