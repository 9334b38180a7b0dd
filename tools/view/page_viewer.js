// Draws the scene of the page with the shaders that haarview draws it with, from where one looks.

const add = (a, b) => a.map((x, i) => x + b[i]);
const scaled = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const normalized = (a) => scaled(a, 1 / Math.hypot(...a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/// Turns v about a unit axis (Rodrigues).
function turned(v, axis, angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return add(add(scaled(v, c), scaled(cross(axis, v), s)), scaled(axis, dot(axis, v) * (1 - c)));
}

class Viewer {
  constructor() {
    if (!gl) throw new Error("this browser offers no WebGL 2");
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("this browser draws to no float images (EXT_color_buffer_float)");
    this.programs = { lamp: new Program(scene.shaders.lamp) };
    if (scene.shaders.environment) this.programs.environment = new Program(scene.shaders.environment);
    this.show = new Program(scene.shaders.show);
    this.textures = scene.textures.map((packed) => [packed.sampler, makeTexture(packed)]);
    this.camera = structuredClone(scene.camera);
    this.lamp = structuredClone(scene.lamp);
    this.toWorld = scene.to_world.slice();
    this.picture = null;
    for (const program of Object.values(this.programs)) {
      for (const [name, values] of Object.entries(scene.floats)) program.floats(name, values);
      for (const [name, value] of Object.entries(scene.integers)) program.integer(name, value);
      program.integer("background", scene.background ? 1 : 0);
    }
  }

  resize(width, height) {
    if (this.picture && this.picture.width === width && this.picture.height === height) return;
    if (this.picture) this.picture.drop();
    this.picture = new Picture(width, height);
    canvas.width = width;
    canvas.height = height;
  }

  /// As camera.glsl wants it.
  aim(program) {
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
    program.floats("ray_towards", parallel ? forward : add(forward, corner));
    program.floats("ray_towards_x", parallel ? none : across);
    program.floats("ray_towards_y", parallel ? none : down);
    program.floats("pixel_size", parallel ? [pixel, 0] : [0, pixel]);
  }

  /// Draws, waits until that is done, and returns the milliseconds it took.
  draw(lighting, level, tolerance) {
    const program = this.programs[lighting];
    this.aim(program);
    const place = this.lamp.at_point ? this.lamp.place : normalized(this.lamp.place);
    program.floats("lamp", [...place, this.lamp.at_point ? 1 : 0]);
    program.floats("irradiance", this.lamp.irradiance);
    program.matrix("to_world", this.toWorld);
    program.floats("tolerance", [tolerance]);
    program.integer("forced_level", level);
    this.textures.forEach(([name, texture], unit) => program.texture(name, unit, texture));
    const begin = performance.now();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.picture.frame);
    gl.viewport(0, 0, this.picture.width, this.picture.height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4)); // waits, as finish() need not
    return performance.now() - begin;
  }

  present(exposure) {
    this.show.floats("area", [0, 0, canvas.width, canvas.height]);
    this.show.floats("exposure", [exposure]);
    this.show.texture("picture", 0, this.picture.texture);
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
    camera.from = add(camera.to, turned(turned(back, side, step), up, -right));
  }

  turnLight(right, down) {
    const up = normalized(this.camera.up);
    const side = normalized(cross(up, add(this.camera.from, scaled(this.camera.to, -1))));
    this.lamp.place = turned(turned(this.lamp.place, up, right), side, down);
    for (let axis = 0; axis < 3; ++axis)
      this.toWorld.splice(3 * axis, 3, ...turned(this.toWorld.slice(3 * axis, 3 * axis + 3), up, right));
  }

  approach(factor) {
    const back = add(this.camera.from, scaled(this.camera.to, -1));
    this.camera.from = add(this.camera.to, scaled(back, factor));
    this.camera.height *= factor;
  }
}
