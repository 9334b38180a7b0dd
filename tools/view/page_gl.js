"use strict";
// What a picture takes of WebGL 2: programs, textures and what is drawn to; and the page's elements.

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
    gl.attachShader(this.id, compiled(gl.VERTEX_SHADER, scene.shaders.cover));
    gl.attachShader(this.id, compiled(gl.FRAGMENT_SHADER, fragment));
    gl.linkProgram(this.id);
    if (!gl.getProgramParameter(this.id, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.id));
  }
  place(name) {
    gl.useProgram(this.id);
    return gl.getUniformLocation(this.id, name);
  }
  floats(name, values) { gl["uniform" + values.length + "fv"](this.place(name), values); }
  integer(name, value) { gl.uniform1i(this.place(name), value); }
  matrix(name, columns) { gl.uniformMatrix3fv(this.place(name), false, columns); }
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
};

function makeTexture(packed) {
  const target = packed.depth > 0 ? gl.TEXTURE_3D : gl.TEXTURE_2D;
  const most = gl.getParameter(packed.depth > 0 ? gl.MAX_3D_TEXTURE_SIZE : gl.MAX_TEXTURE_SIZE);
  for (const side of [packed.width, packed.height, packed.depth])
    if (side > most) throw new Error(`a texture of ${side} texels a side is needed; ${most} are possible here`);
  const id = gl.createTexture();
  gl.activeTexture(gl.TEXTURE15);
  gl.bindTexture(target, id);
  const filter = packed.depth > 0 ? gl.LINEAR : gl.NEAREST;
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, packed.mips ? gl.NEAREST_MIPMAP_NEAREST : filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(target, wrap, gl.CLAMP_TO_EDGE);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  const [internal, format, type, size, Values] = formats[packed.texel];
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

class Picture {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.texture = makeTexture({ texel: "Rgba32F", width, height, depth: 0, mips: false });
    this.frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.texture.id, 0);
  }
  drop() {
    gl.deleteFramebuffer(this.frame);
    gl.deleteTexture(this.texture.id);
  }
  read() {
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    const rgba = new Float32Array(4 * this.width * this.height);
    gl.readPixels(0, 0, this.width, this.height, gl.RGBA, gl.FLOAT, rgba);
    return rgba;
  }
}
