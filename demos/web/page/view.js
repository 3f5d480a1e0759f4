// Draws particles as balls and the cloth as a lit sheet, with WebGL 2.

const light = 'const vec3 light = normalize(vec3(0.3, 0.8, 0.5));\n';

const ball_vertex = `#version 300 es
in vec4 particle;  // position, speed
uniform mat4 view, projection;
uniform float radius, height, fastest;
out vec3 centre;
out vec3 colour;
void main() {
  vec4 at = view * vec4(particle.xyz, 1.0);
  centre = at.xyz;
  float s = clamp(particle.w / fastest, 0.0, 1.0);
  colour = mix(vec3(0.12, 0.36, 0.62), vec3(0.55, 0.80, 0.95), s * s);
  gl_Position = projection * at;
  gl_PointSize = max(2.0, height * projection[1][1] * radius / gl_Position.w);
}`;
const ball_fragment = `#version 300 es
precision highp float;
in vec3 centre;
in vec3 colour;
uniform mat4 projection;
uniform float radius;
out vec4 result;
${light}
void main() {
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  float square = dot(d, d);
  if (square > 1.0) discard;
  vec3 normal = vec3(d.x, -d.y, sqrt(1.0 - square));
  vec4 place = projection * vec4(centre + radius * normal, 1.0);
  gl_FragDepth = 0.5 * place.z / place.w + 0.5;
  float diffuse = max(dot(normal, light), 0.0);
  float shine = pow(max(dot(normal, normalize(light + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
  result = vec4(colour * (0.55 + 0.5 * diffuse) + 0.25 * shine, 1.0);
}`;
const sheet_vertex = `#version 300 es
in vec3 node;
in vec3 normal;
uniform mat4 view, projection;
out vec3 facing;
void main() {
  facing = mat3(view) * normal;
  gl_Position = projection * view * vec4(node, 1.0);
}`;
const sheet_fragment = `#version 300 es
precision highp float;
in vec3 facing;
uniform vec3 colour;
uniform float shade;
out vec4 result;
${light}
void main() {
  vec3 n = normalize(facing);
  if (n.z < 0.0) n = -n;
  result = vec4(colour * mix(1.0, 0.55 + 0.5 * max(dot(n, light), 0.0), shade), 1.0);
}`;

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

/// A tube around the nozzle's mouth, as triangles: positions and normals.
function tube(nozzle) {
  const d = nozzle.direction, other = Math.abs(d[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const l = Math.hypot(...a); return a.map((x) => x / l); };
  const u = unit(cross(d, other)), v = cross(d, u), points = [], normals = [], index = [], sides = 40;
  for (let i = 0; i < sides; ++i) {
    const t = 2 * Math.PI * i / sides, n = u.map((x, k) => x * Math.cos(t) + v[k] * Math.sin(t));
    for (const along of [0, 0.05]) {
      for (let k = 0; k < 3; ++k) points.push(nozzle.center[k] + 1.12 * nozzle.radius * n[k] - along * d[k]);
      normals.push(...n);
    }
    const a = 2 * i, b = 2 * ((i + 1) % sides);
    index.push(a, a + 1, b, b, a + 1, b + 1);
  }
  return {points: new Float32Array(points), normals: new Float32Array(normals), index: new Uint32Array(index)};
}

export function vertex_normals(nodes, triangles) {
  const normals = new Float32Array(nodes.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const u = [nodes[b] - nodes[a], nodes[b + 1] - nodes[a + 1], nodes[b + 2] - nodes[a + 2]];
    const v = [nodes[c] - nodes[a], nodes[c + 1] - nodes[a + 1], nodes[c + 2] - nodes[a + 2]];
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) normals[corner + k] += n[k];
  }
  return normals;
}

export class View {
  /// Throws where the browser has no WebGL 2.
  constructor(canvas) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext('webgl2', {alpha: true, premultipliedAlpha: false, preserveDrawingBuffer: true});
    if (!gl) throw new Error('this browser has no WebGL 2');
    this.balls = program(gl, ball_vertex, ball_fragment);
    this.sheet = program(gl, sheet_vertex, sheet_fragment);
    this.buffers = {};
    this.nozzle = this.tube = null;
    gl.enable(gl.DEPTH_TEST);
    this.particles = this.nodes = new Float32Array();
    this.triangles = new Uint32Array();
  }

  open(description, triangles) {
    this.radius = 0.5 * description.spacing;
    this.triangles = triangles;
    const edges = new Set();
    for (let t = 0; t < triangles.length; t += 3)
      for (let k = 0; k < 3; ++k) {
        const [a, b] = [triangles[t + k], triangles[t + (k + 1) % 3]];
        if (b - a === 1 || a - b === 1 || Math.abs(a - b) > 2) edges.add(Math.min(a, b) * 65536 + Math.max(a, b));
      }
    // Every fourth line of a grid, so that folds can be seen.
    this.edges = new Uint32Array([...edges].flatMap((e) => [Math.floor(e / 65536), e % 65536]));
  }

  aim(nozzle) {
    this.nozzle = nozzle;
    this.tube = nozzle ? tube(nozzle) : null;
  }

  buffer(name, target, data) {
    const gl = this.gl;
    this.buffers[name] = this.buffers[name] || gl.createBuffer();
    gl.bindBuffer(target, this.buffers[name]);
    gl.bufferData(target, data, gl.DYNAMIC_DRAW);
  }
  attribute(of, name, size) {
    const gl = this.gl, at = gl.getAttribLocation(of, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
  }

  draw(camera) {
    const gl = this.gl, ratio = window.devicePixelRatio || 1;
    const width = Math.round(this.canvas.clientWidth * ratio), height = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) [this.canvas.width, this.canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const matrices = {view: camera.view(), projection: camera.projection(width / height)};
    this.draw_sheets(matrices);
    this.draw_balls(matrices, height);
  }

  draw_sheets(matrices) {
    const gl = this.gl, sheet = this.sheet;
    gl.useProgram(sheet);
    for (const name in matrices) gl.uniformMatrix4fv(gl.getUniformLocation(sheet, name), false, matrices[name]);
    const draw = (points, normals, index, kind, colour, shade) => {
      this.buffer('nodes', gl.ARRAY_BUFFER, points);
      this.attribute(sheet, 'node', 3);
      this.buffer('normals', gl.ARRAY_BUFFER, normals);
      this.attribute(sheet, 'normal', 3);
      this.buffer('index', gl.ELEMENT_ARRAY_BUFFER, index);
      gl.uniform3fv(gl.getUniformLocation(sheet, 'colour'), colour);
      gl.uniform1f(gl.getUniformLocation(sheet, 'shade'), shade);
      gl.drawElements(kind, index.length, gl.UNSIGNED_INT, 0);
    };
    if (this.nodes.length) {
      const normals = vertex_normals(this.nodes, this.triangles);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
      draw(this.nodes, normals, this.triangles, gl.TRIANGLES, [0.80, 0.46, 0.33], 1);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      draw(this.nodes, normals, this.edges, gl.LINES, [0.66, 0.36, 0.25], 0.4);
    }
    if (this.tube) draw(this.tube.points, this.tube.normals, this.tube.index, gl.TRIANGLES, [0.45, 0.50, 0.55], 1);
  }

  draw_balls(matrices, height) {
    if (!this.particles.length) return;
    const gl = this.gl, balls = this.balls;
    gl.useProgram(balls);
    for (const name in matrices) gl.uniformMatrix4fv(gl.getUniformLocation(balls, name), false, matrices[name]);
    for (const [name, value] of [['radius', this.radius], ['height', height], ['fastest', 3]])
      gl.uniform1f(gl.getUniformLocation(balls, name), value);
    gl.disableVertexAttribArray(1);
    this.buffer('particles', gl.ARRAY_BUFFER, this.particles);
    this.attribute(balls, 'particle', 4);
    gl.drawArrays(gl.POINTS, 0, this.particles.length / 4);
  }
}
